#include "cli/descent.h"

#include <fmt/format.h>

#include <cmath>

#include "cli/console.h"
#include "cli/interrupt.h"
#include "cli/progress.h"
#include "core/stopwatch.h"

namespace burnish {

namespace {

HistoryRow make_row(const IterationReport& report, double seconds) {
    const GradientCounts& c = report.counts;
    return {report.iteration,
            seconds,
            report.image_seconds,
            report.derivative_seconds,
            report.step_seconds,
            report.loss,
            c.records,
            c.candidates,
            c.texels,
            c.reservoirs,
            c.rejected + report.rejected_image,
            {}};
}

/// Looks every few iterations whether the loss still falls, with the same samples each time, so
/// that most of their noise is no difference.
class Patience {
  public:
    explicit Patience(std::uint32_t most) : most_(most) {}

    /// Checks the state where it is time to.
    std::optional<double> check(const Problem& problem, const SolveOptions& options,
                                const SolveState& state) {
        constexpr std::uint32_t kEvery = 20, kSamples = 8;
        constexpr std::uint32_t kSalt = 100;  // not that of the start or of a result
        if (most_ == 0 || state.iteration % kEvery != 0) return {};
        const auto image = [&](std::uint32_t salt) {
            return evaluate(problem, options, state.theta, kSamples, salt).image;
        };
        const double loss = loss_of_halves(options.loss, image(kSalt), image(kSalt + 1),
                                           problem.target, problem.mask);
        failed_ = loss < least_ ? 0 : failed_ + 1;
        least_ = std::min(least_, loss);
        return loss;
    }
    bool is_over() const { return most_ > 0 && failed_ >= most_; }

  private:
    std::uint32_t most_, failed_ = 0;
    double least_ = std::numeric_limits<double>::infinity();
};

std::string progress_text(const std::vector<HistoryRow>& rows, const Budget& budget) {
    const HistoryRow& last = rows.back();
    const double each = last.seconds / static_cast<double>(rows.size());
    const bool counted = budget.iterations != Budget{}.iterations;
    double left = budget.seconds - last.seconds;
    if (counted) left = std::min(left, each * static_cast<double>(budget.iterations - rows.size()));
    return fmt::format("{}{}  loss {:.4g}  {:.3g} s/iteration  {}", rows.size(),
                       counted ? fmt::format("/{}", budget.iterations) : "", last.loss, each,
                       std::isfinite(left)
                           ? fmt::format("{} left", duration_text(std::max(0.0, left)))
                           : "until the loss falls no longer");
}

}  // namespace

Descent descend_with_progress(const Problem& problem, const SolveOptions& options,
                      const std::vector<InitialTexture>& textures, const Budget& budget) {
    const Stopwatch watch;
    ProgressLine line("iteration");
    Descent descent;
    SolveState state = start(options, textures);
    Patience patience(budget.patience);
    do {
        const IterationReport report = iterate(problem, options, state);
        descent.rows.push_back(make_row(report, watch.total()));
        descent.rows.back().checked_loss = patience.check(problem, options, state);
        descent.seconds = watch.total();
        add_counts(descent.counts, report.counts, report.iteration);
        descent.rejected_image += report.rejected_image;
        line.show(progress_text(descent.rows, budget));
    } while (!interrupted() && !patience.is_over() && descent.rows.size() < budget.iterations &&
             descent.seconds < budget.seconds);
    descent.ending = interrupted()                             ? Ending::kSignal
                     : patience.is_over()                      ? Ending::kPatience
                     : descent.rows.size() < budget.iterations ? Ending::kTime
                                                               : Ending::kIterations;
    descent.theta = std::move(state.theta);
    for (TextureParameters& p : state.parameters)
        descent.evidence.push_back({std::move(p.visits), confidence(p)});
    return descent;
}

std::vector<std::pair<std::string, Image>> evidence_maps(const Descent& descent, std::size_t i) {
    const TexelEvidence& evidence = descent.evidence[i];
    const Image& texels = descent.theta.textures[i].values;
    Image coverage = make_image(texels.width, texels.height, 1);
    for (std::size_t t = 0; t < coverage.values.size(); ++t)
        coverage.values[t] =
            static_cast<float>(evidence.visits[t]) / static_cast<float>(descent.rows.size());
    std::vector<std::pair<std::string, Image>> maps{{"coverage", std::move(coverage)}};
    if (evidence.confidence.width > 0) maps.emplace_back("confidence", evidence.confidence);
    return maps;
}

std::string history_csv(const std::vector<HistoryRow>& rows) {
    std::string csv =
        "iteration,seconds,image_seconds,derivative_seconds,step_seconds,loss,records,candidates,"
        "texels,reservoirs,rejected,checked_loss\n";
    for (const HistoryRow& r : rows)
        csv += fmt::format("{},{:.6f},{:.6f},{:.6f},{:.6f},{:.9g},{},{},{},{},{},{}\n", r.iteration,
                           r.seconds, r.image_seconds, r.derivative_seconds, r.step_seconds, r.loss,
                           r.records, r.candidates, r.texels, r.reservoirs, r.rejected,
                           r.checked_loss ? fmt::format("{:.9g}", *r.checked_loss) : "");
    return csv;
}

const char* name_of(Ending ending) {
    switch (ending) {
        case Ending::kIterations:
            return "iterations";
        case Ending::kTime:
            return "time";
        case Ending::kPatience:
            return "patience";
        case Ending::kSignal:
            return "signal";
    }
    return "";
}

}  // namespace burnish
