#include "cli/solve_progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/console.h"
#include "cli/interrupt.h"
#include "optimize/setup.h"

namespace burnish {

namespace {

std::string progress_text(const Iteration& last, std::uint32_t done, const Stop& stop) {
    const double each = last.seconds / done;
    const bool counted = stop.iterations != Stop{}.iterations;
    double left = stop.seconds - last.seconds;
    if (counted) left = std::min(left, each * (stop.iterations - done));
    return fmt::format("{}{}  loss {:.4g}  {:.3g} s/iteration  {}", done,
                       counted ? fmt::format("/{}", stop.iterations) : "", last.loss, each,
                       std::isfinite(left)
                           ? fmt::format("{} left", duration_text(std::max(0.0, left)))
                           : "until the loss falls no longer");
}

}  // namespace

SolveProgress::SolveProgress(const Options& options, std::uint32_t done)
    : stop_(effective_stop(options)),
      done_(done),
      ticking_(std::make_unique<TickingLine>("preparing")) {}

Callback SolveProgress::callback() {
    return [this](const Iteration& i) {
        show_iteration(i);
        return interrupted() ? Cancel : Continue;
    };
}

StageProgress SolveProgress::stages() {
    return [this](const char* stage, double share) { show_stage(stage, share); };
}

void SolveProgress::begin_line(const std::string& title) {
    if (title_ == title) return;
    ticking_.reset(), line_.reset();
    title_ = title;
    line_ = std::make_unique<ProgressLine>(title_);
}

void SolveProgress::show_iteration(const Iteration& iteration) {
    ++done_;
    begin_line("iteration");
    line_->show(progress_text(iteration, done_, stop_));
}

void SolveProgress::show_stage(const char* stage, double share) {
    begin_line(stage);
    line_->show_share(share);
    if (share < 1) return;
    // What comes next takes a while before it says so.
    line_.reset();
    title_ = "iteration 1";
    if (done_ == 0) ticking_ = std::make_unique<TickingLine>(title_);
}

}  // namespace burnish
