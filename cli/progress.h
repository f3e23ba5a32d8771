// Progress of what takes long: one line on standard error that is rewritten in place on a terminal.
// Where standard error is none, or a dumb one, it is a line every ten seconds.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <thread>

#include "burnish/renderer.h"

namespace burnish {

/// What a line of a terminal of so many columns, at least two, shows without wrapping: the title, a
/// bar of the share where six cells of one have room, and the text, of which nothing is cut while
/// it has room itself. "…" ends a title that has too little. Texts are UTF-8.
std::string progress_line(const std::string& title, const std::string& text,
                          std::optional<double> share, std::size_t columns);

/// Erases its line when it goes. Calls must come one at a time.
class ProgressLine {
  public:
    explicit ProgressLine(std::string title);
    ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    /// "title  text"; at most ten times a second on a terminal.
    void show(const std::string& text);
    /// A bar, the share in percent and the time that is left, by the pace since the first share
    /// that it has heard: what goes on begins with one that is not 0.
    void show_share(double share);

  private:
    using Clock = std::chrono::steady_clock;
    bool is_due() const;
    void write(const std::string& text, std::optional<double> share);
    std::string title_;
    bool rewrites_;
    Clock::time_point start_ = Clock::now(), shown_{};
    struct Heard {
        double share;
        Clock::time_point at;
    };
    std::optional<Heard> first_;  ///< share that it has heard
};

/// Shows the share that is done. The line must outlive it.
inline Progress progress_of(ProgressLine& line) {
    return [&line](double share) { line.show_share(share); };
}

/// Shows a title and the seconds since then, for work that does not say how far it is.
class TickingLine {
  public:
    explicit TickingLine(const std::string& title);

  private:
    std::jthread ticker_;  ///< stops and joins when it goes
};

}  // namespace burnish
