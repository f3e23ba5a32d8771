// Ctrl-C and kill. A signal ends the program, once what is unfinished has been removed; while an
// InterruptGuard lives, the first one only asks to end after the current iteration.
#pragma once

#include <functional>
#include <mutex>

namespace burnish {

/// Begins to watch for SIGINT, SIGTERM and SIGHUP (unless it is ignored, as by nohup), in a thread
/// of its own. Call it before there are other threads: they inherit that the signals are blocked. A
/// reader of our output that leaves does not end the program: SIGPIPE is ignored.
void watch_signals();

/// What is done before a signal ends the program; empty: nothing.
void set_clean_up(std::function<void()> clean_up);

/// While it lives, the first signal sets a flag; a second one ends the program.
class InterruptGuard {
  public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
};

/// True once a signal came while a guard lived.
bool interrupted();

/// While it lives no signal ends the program: for steps that are done as a whole or not at all.
/// They should be short.
class WholeStep {
  public:
    WholeStep();

  private:
    std::unique_lock<std::recursive_mutex> lock_;
};

}  // namespace burnish
