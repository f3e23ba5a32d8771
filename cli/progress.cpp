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

/// A line that wraps could not be rewritten. Nothing is said, nor thrown, where the terminal is
/// gone: the work goes on.
void rewrite_line(const std::string& text) {
    std::fputs(("\r" + text + "\x1b[K").c_str(), stderr);
    std::fflush(stderr);
}

bool begins_letter(char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }

/// Of a terminal, at most: letters from U+1000 on, as those of Chinese, may take two.
std::size_t columns_of(const std::string& utf8) {
    std::size_t columns = 0;
    for (const char c : utf8) {
        columns += begins_letter(c);
        columns += static_cast<unsigned char>(c) >= 0xe1;
    }
    return columns;
}

std::string shortened(std::string text, std::size_t columns) {
    if (columns_of(text) <= columns) return text;
    const std::string end = "…";
    if (columns_of(end) > columns) return "";
    while (columns_of(text + end) > columns) {
        while (!begins_letter(text.back())) text.pop_back();
        text.pop_back();
    }
    return text + end;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

std::string progress_line(const std::string& title, const std::string& text,
                          std::optional<double> share, std::size_t columns) {
    constexpr std::size_t kMax = 24, kMin = 6, kFrame = 3;  // of a bar; its ends and a space
    const std::size_t all = columns - 1;                    // a full line would wrap
    const std::string numbers = "  " + printable(text);
    const std::size_t room = all - std::min(all, columns_of(numbers));
    const std::string name = shortened(printable(title), room);
    const std::size_t left = room - columns_of(name);
    if (!share || left < kMin + kFrame) return shortened(name + numbers, all);
    const std::size_t cells = std::min(kMax, left - kFrame);
    const auto filled =
        static_cast<std::size_t>(std::clamp(*share, 0.0, 1.0) * static_cast<double>(cells));
    return fmt::format("{}  [{:=<{}}{: <{}}] {}", name, "", filled, "", cells - filled,
                       numbers.substr(2));
}

ProgressLine::ProgressLine(std::string title)
    : title_(std::move(title)), rewrites_(can_rewrite_lines()) {}

ProgressLine::~ProgressLine() {
    if (rewrites_ && shown_ != Clock::time_point{}) rewrite_line("");
}

bool ProgressLine::is_due() const {
    if (rewrites_) return seconds_since(shown_) >= 0.1;
    return seconds_since(std::max(start_, shown_)) >= 10;
}

void ProgressLine::write(const std::string& text, std::optional<double> share) {
    shown_ = Clock::now();
    if (rewrites_)
        rewrite_line(progress_line(title_, text, share, terminal_columns()));
    else
        log_info(title_ + "  " + text);
}

void ProgressLine::show(const std::string& text) {
    if (is_due()) write(text, {});
}

void ProgressLine::show_share(double share) {
    if (!first_) first_ = {share, Clock::now()};
    if (!is_due()) return;
    const double done = share - first_->share, elapsed = seconds_since(first_->at);
    const std::string left =
        done > 0 ? "  " + duration_text(elapsed / done * (1 - share)) + " left" : "";
    write(fmt::format("{:3.0f} %{}", 100 * share, left), share);
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
