// Ctrl-C and kill. A signal ends the program, once what is unfinished has been removed; while an
// InterruptGuard lives, the first one only asks to end after the current iteration. SIGTERM,
// SIGHUP and SIGXCPU come from the system, which does not wait for long.
#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <utility>

namespace burnish {

/// Begins to watch for SIGINT, SIGTERM, and, unless they are ignored, as by nohup, SIGHUP and
/// SIGXCPU (a limit of processor time is reached), in a thread of its own. Call it before there are
/// other threads: they inherit that the signals are blocked. A reader of our output that leaves
/// does not end the program, nor does a file that has become too large: SIGPIPE and SIGXFSZ are
/// ignored. Throws std::system_error where the system has no thread.
void watch_signals();
/// From now on SIGINT does nothing: of several processes the first one alone is asked by it.
void ignore_interrupts();

/// What is done once: when it is destroyed, or before a signal ends the program. While it is done
/// no signal ends the program. One at a time holds something to do.
class CleanUp {
  public:
    CleanUp() = default;  ///< nothing is to be done
    explicit CleanUp(std::function<void()> body);
    CleanUp(CleanUp&& other) noexcept : body_(std::exchange(other.body_, {})) {}
    CleanUp& operator=(CleanUp&& other) noexcept {
        body_.swap(other.body_);
        return *this;
    }
    ~CleanUp();

  private:
    std::function<void()> body_;
};

/// While it lives, the first signal sets a flag; a second one ends the program. The same one within
/// 200 ms counts as one: `timeout` sends it twice. SIGXCPU, which the kernel sends each second once
/// the limit is reached, is no second one.
class InterruptGuard {
  public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
};

/// True once a signal came while a guard lived.
bool interrupted();
/// The same of SIGTERM, SIGHUP and SIGXCPU: what is left to do must wait for another time.
bool interrupted_by_system();

/// Ends the program as the signal that came would have without a guard. message: what is said where
/// nothing lies on the disk; empty: nothing.
[[noreturn]] void end_interrupted(const std::string& message = {});

/// What lies on the disk of the present run.
enum class OnDisk {
    kNothing,  ///< a signal ends the program as if nobody had caught it
    kPart,     ///< the run can go on: a signal ends the program with kInterrupted
    kAll,      ///< so it can, and the signals of the system do so although a guard lives
    kResults,  ///< nothing is left to do: the first signal only tells that it came
};
/// hint: what is said when a signal ends the program.
void set_on_disk(OnDisk what, const std::string& hint = {});

/// While it lives no signal ends the program: for steps that are done as a whole or not at all.
/// They should be short.
class WholeStep {
  public:
    WholeStep();

  private:
    std::unique_lock<std::recursive_mutex> lock_;
};

}  // namespace burnish
