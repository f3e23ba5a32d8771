#include "cli/interrupt.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "cli/console.h"
#include "cli/exit_codes.h"

namespace burnish {

namespace {

/// Of the process: signals are, too.
struct Watch {
    std::recursive_mutex mutex;  ///< guards the rest
    std::function<void()> clean_up;
    bool ignores_interrupts = false;
    int guards = 0;
    int came = 0;  ///< the signal that came while a guard lived
    std::chrono::steady_clock::time_point came_at = {};
    OnDisk on_disk = OnDisk::kNothing;
    std::string hint;
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
    for (const int signal : {SIGHUP, SIGXCPU}) {
        struct sigaction action {};
        if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler != SIG_IGN)
            sigaddset(&set, signal);
    }
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

/// What lies on the disk decides how.
[[noreturn]] void end_program(const Watch& w, int signal) {
    if (w.clean_up) w.clean_up();
    if (w.on_disk == OnDisk::kNothing || w.on_disk == OnDisk::kResults) end_by(signal);
    log_info(w.hint);
    std::_Exit(kInterrupted);
}

/// `timeout` sends a signal to its child and at once to the group, which the child is in: one that
/// comes again sooner than a person asks is the same one.
bool is_repetition(const Watch& w, int signal) {
    constexpr std::chrono::milliseconds kSooner{200};
    return signal == w.came && std::chrono::steady_clock::now() - w.came_at < kSooner;
}

void wait_for_signals() {
    const sigset_t set = watched_signals();
    int signal = 0;
    while (sigwait(&set, &signal) == 0) {
        Watch& w = watch();
        const std::lock_guard lock(w.mutex);
        if (signal == SIGINT && w.ignores_interrupts) continue;
        if (is_repetition(w, signal)) continue;
        const bool ends_now = w.on_disk == OnDisk::kAll && signal != SIGINT;
        const bool may_wait = w.on_disk == OnDisk::kResults || (w.guards > 0 && !ends_now);
        // The kernel repeats SIGXCPU each second: none of them is impatient.
        if (may_wait && (w.came == 0 || signal == SIGXCPU)) {
            w.came = signal, w.came_at = std::chrono::steady_clock::now();
            continue;
        }
        end_program(w, signal);
    }
}

}  // namespace

void watch_signals() {
    const sigset_t set = watched_signals();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);  // a write beyond `ulimit -f` fails instead
    std::thread(wait_for_signals).detach();
}

void ignore_interrupts() {
    const std::lock_guard lock(watch().mutex);
    watch().ignores_interrupts = true;
}

CleanUp::CleanUp(std::function<void()> body) : body_(std::move(body)) {
    const std::lock_guard lock(watch().mutex);
    watch().clean_up = body_;
}

CleanUp::~CleanUp() {
    if (!body_) return;
    const WholeStep whole;
    watch().clean_up = {};
    body_();
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
    return watch().came != 0;
}

bool interrupted_by_system() {
    const std::lock_guard lock(watch().mutex);
    const int came = watch().came;
    return came == SIGTERM || came == SIGHUP || came == SIGXCPU;
}

void end_interrupted(const std::string& message) {
    const std::lock_guard lock(watch().mutex);
    if (watch().on_disk == OnDisk::kNothing && !message.empty()) log_info(message);
    end_program(watch(), watch().came);
}

void set_on_disk(OnDisk what, const std::string& hint) {
    const std::lock_guard lock(watch().mutex);
    watch().on_disk = what, watch().hint = hint;
}

WholeStep::WholeStep() : lock_(watch().mutex) {}

}  // namespace burnish
