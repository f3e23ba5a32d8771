#include "cli/interrupt.h"

#include <csignal>

namespace burnish {

namespace {

// A signal handler can reach nothing but globals.
volatile std::sig_atomic_t signal_came = 0;

void restore_defaults() {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
}

void on_signal(int) {
    signal_came = 1;
    restore_defaults();
}

}  // namespace

InterruptGuard::InterruptGuard() {
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
}

InterruptGuard::~InterruptGuard() { restore_defaults(); }

bool interrupted() { return signal_came != 0; }

}  // namespace burnish
