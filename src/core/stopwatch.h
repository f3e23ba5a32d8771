// Wall-clock seconds of what is measured on the way: stages, phases, whole runs.
#pragma once

#include <chrono>
#include <utility>

namespace burnish {

/// Runs from its construction. Steady: a change of the system's time does not show.
class Stopwatch {
  public:
    /// Seconds since the last lap, or since the start.
    double lap() {
        const auto now = Clock::now();
        return seconds(std::exchange(last_, now), now);
    }
    /// Seconds since the start.
    double total() const { return seconds(start_, Clock::now()); }

  private:
    using Clock = std::chrono::steady_clock;
    static double seconds(Clock::time_point from, Clock::time_point to) {
        return std::chrono::duration<double>(to - from).count();
    }
    Clock::time_point start_ = Clock::now(), last_ = start_;
};

}  // namespace burnish
