#include "cli/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <cstdio>
#include <mutex>

#include "cli/console.h"

namespace burnish {

namespace {

std::size_t terminal_columns() {
    winsize size{};
    const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
    return known ? size.ws_col : 80;
}

/// The line is cut where it would wrap: a wrapped line cannot be rewritten.
void rewrite_line(const std::string& text) {
    fmt::print(stderr, "\r{}\x1b[K", printable(text).substr(0, terminal_columns() - 1));
    std::fflush(stderr);
}

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

ProgressLine::ProgressLine(std::string title)
    : title_(std::move(title)), rewrites_(can_rewrite_lines()) {}

ProgressLine::~ProgressLine() {
    if (rewrites_ && shown_ != Clock::time_point{}) rewrite_line("");
}

bool ProgressLine::is_due() const {
    if (rewrites_) return seconds_since(shown_) >= 0.1;
    return seconds_since(std::max(start_, shown_)) >= 10;
}

void ProgressLine::show(const std::string& text) {
    if (!is_due()) return;
    shown_ = Clock::now();
    const std::string line = title_ + "  " + text;
    if (rewrites_)
        rewrite_line(line);
    else
        log_info(line);
}

void ProgressLine::show_share(double share) {
    if (!first_) first_ = {share, Clock::now()};
    if (!is_due()) return;
    constexpr int kBar = 24;
    const int filled = static_cast<int>(share * kBar);
    const double done = share - first_->share, elapsed = seconds_since(first_->at);
    const std::string left = done > 0 ? duration_text(elapsed / done * (1 - share)) + " left" : "";
    const std::string bar =
        rewrites_ ? fmt::format("[{:=<{}}{: <{}}] ", "", filled, "", kBar - filled) : "";
    show(fmt::format("{}{:3.0f} %  {}", bar, 100 * share, left));
}

TickingLine::TickingLine(const std::string& title)
    : ticker_([title](const std::stop_token& stop) {
          ProgressLine line(title);
          const auto start = std::chrono::steady_clock::now();
          std::mutex mutex;
          std::condition_variable_any wake;
          std::unique_lock lock(mutex);
          while (!stop.stop_requested()) {
              line.show(duration_text(seconds_since(start)));
              wake.wait_for(lock, stop, std::chrono::milliseconds(250), [] { return false; });
          }
      }) {}

}  // namespace burnish
