#include "cli/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

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
    fmt::print(stderr, "\r{}\x1b[K", text.substr(0, terminal_columns() - 1));
    std::fflush(stderr);
}

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

ProgressLine::ProgressLine(std::string title)
    : title_(std::move(title)), terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressLine::~ProgressLine() {
    if (terminal_ && shown_ != Clock::time_point{}) rewrite_line("");
}

void ProgressLine::show(const std::string& text) {
    if (!terminal_ || seconds_since(shown_) < 0.1) return;
    shown_ = Clock::now();
    rewrite_line(title_ + "  " + text);
}

void ProgressLine::show_share(double share) {
    if (!terminal_ || seconds_since(shown_) < 0.1) return;
    constexpr int kBar = 24;
    const int filled = static_cast<int>(share * kBar);
    const double elapsed = seconds_since(start_);
    const std::string left =
        share > 0 ? duration_text(elapsed / share * (1 - share)) + " left" : "";
    show(fmt::format("[{:=<{}}{: <{}}] {:3.0f} %  {}", "", filled, "", kBar - filled, 100 * share,
                     left));
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
