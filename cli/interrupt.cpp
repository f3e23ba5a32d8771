#include "cli/interrupt.h"

#include <csignal>
#include <thread>

namespace burnish {

namespace {

/// Of the process: signals are, too.
struct Watch {
    std::recursive_mutex mutex;  ///< guards the rest
    std::function<void()> clean_up;
    int guards = 0;
    bool came = false;  ///< a signal, while a guard lived
};

/// Never destroyed: the watching thread may outlive everything.
Watch& watch() {
    static Watch& only = *new Watch;
    return only;
}

sigset_t watched_signals() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    struct sigaction action {};
    if (sigaction(SIGHUP, nullptr, &action) == 0 && action.sa_handler != SIG_IGN)
        sigaddset(&set, SIGHUP);
    return set;
}

/// As if nobody had caught the signal: the caller's shell sees what ended the program.
[[noreturn]] void end_by(int signal) {
    std::signal(signal, SIG_DFL);
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, signal);
    pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
    std::raise(signal);
    std::_Exit(128 + signal);
}

void wait_for_signals() {
    const sigset_t set = watched_signals();
    int signal = 0;
    while (sigwait(&set, &signal) == 0) {
        Watch& w = watch();
        const std::lock_guard lock(w.mutex);
        if (w.guards > 0 && !w.came) {
            w.came = true;
            continue;
        }
        if (w.clean_up) w.clean_up();
        end_by(signal);
    }
}

}  // namespace

void watch_signals() {
    const sigset_t set = watched_signals();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
    std::thread(wait_for_signals).detach();
}

void set_clean_up(std::function<void()> clean_up) {
    const std::lock_guard lock(watch().mutex);
    watch().clean_up = std::move(clean_up);
}

InterruptGuard::InterruptGuard() {
    const std::lock_guard lock(watch().mutex);
    ++watch().guards;
}

InterruptGuard::~InterruptGuard() {
    const std::lock_guard lock(watch().mutex);
    --watch().guards;
}

bool interrupted() {
    const std::lock_guard lock(watch().mutex);
    return watch().came;
}

WholeStep::WholeStep() : lock_(watch().mutex) {}

}  // namespace burnish
