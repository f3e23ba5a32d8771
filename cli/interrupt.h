// Ctrl-C and kill: the first signal asks to end after the current iteration, the second one ends
// the program at once.
#pragma once

namespace burnish {

/// While it lives, SIGINT and SIGTERM set a flag, once; a second one, and any
/// later, ends the program.
class InterruptGuard {
  public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
};

/// True once a signal came while a guard lived.
bool interrupted();

}  // namespace burnish
