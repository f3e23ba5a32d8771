#include "python/work.h"

#include <nanobind/nanobind.h>
#include <unistd.h>

#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "burnish/error.h"

namespace nb = nanobind;

namespace burnish::python {

namespace {

/// Of the process, as threads and forks are.
struct Process {
    std::mutex mutex;
    std::condition_variable changed;
    int working = 0;  ///< pieces of work
    std::atomic<bool> is_ending = false;
    pid_t worked = 0;  ///< the process that began the first one; 0: none did
};

/// Never destroyed: threads may outlive everything.
Process& process() {
    static Process& only = *new Process;
    return only;
}

/// Whether this process is a fork of one that had worked: threads are not forked.
bool is_forked() { return process().worked != 0 && process().worked != getpid(); }

void require_threads() {
    if (process().is_ending) throw Error("the interpreter ends: no work begins");
    if (is_forked())
        throw Error(
            "this process was forked after Burnish had begun to work, and threads are not forked: "
            "use multiprocessing's start method \"spawn\" or \"forkserver\"");
}

void begin_work() {
    const std::lock_guard lock(process().mutex);
    process().worked = getpid();
    ++process().working;
}

void end_work() {
    const std::lock_guard lock(process().mutex);
    --process().working;
    process().changed.notify_all();
}

/// Of the threads of workers, and of others while their work calls Python: the end of the
/// interpreter waits for them.
thread_local bool works = false;

/// Of a daemon's thread once the interpreter ends: it must not take the GIL any more.
[[noreturn]] void hang() {
    while (true) std::this_thread::sleep_for(std::chrono::hours(1));
}

/// Of the thread that asks; raises what a signal's handler raises.
void hear_signals() {
    const nb::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() != 0) nb::raise_python_error();
}

/// What Python has printed and still holds.
void flush_output() {
    const nb::gil_scoped_acquire gil;
    for (const char* name : {"stdout", "stderr"}) {
        const nb::handle stream = PySys_GetObject(name);
        try {
            if (stream.is_valid() && !stream.is_none()) stream.attr("flush")();
        } catch (const nb::python_error&) {
            continue;  // such as of a stream that is closed
        }
    }
}

/// As the default action of Ctrl-C does. Not by an exception: work would go on in an interpreter
/// that is no more.
[[noreturn]] void end_by_signal() {
    std::signal(SIGINT, SIG_DFL);  // another one ends what a stream waits for
    flush_output();
    std::raise(SIGINT);
    std::abort();  // where the signal is blocked
}

}  // namespace

struct Worker::Shared {
    std::mutex mutex;  ///< guards the rest
    std::condition_variable changed;
    std::function<void()> work;  ///< that is to be begun
    bool busy = false;           ///< from a call until its work has ended, or its call has
    bool waited_for = false;     ///< by the call
    bool done = false;           ///< the work has ended, and its call waits
    std::exception_ptr error;    ///< of work that is done
    bool closed = false;
    std::thread::id thread = {};  ///< of the worker, once it has begun
    std::thread::id caller = {};  ///< whose call waits for its work, and may hear signals meanwhile
};

namespace {

using Lock = std::unique_lock<std::mutex>;

/// Waits without the GIL until holds(), which is asked under the lock, and hears signals. Throws
/// Error where the work that calls is given up, for the interpreter ends.
template <class Shared, class Condition>
void wait_until(Shared& s, const Condition& holds) {
    const nb::gil_scoped_release without;
    Lock lock(s.mutex);
    while (true) {
        const bool is_over = s.changed.wait_for(lock, kPatience, holds);
        const bool is_ending = process().is_ending;
        if (is_over && (works || !is_ending)) return;
        lock.unlock();
        if (is_ending && works) throw Error("the interpreter ends: this work is given up");
        if (is_ending) hang();
        hear_signals();
        lock.lock();
    }
}

/// Does what there is to do, and says so. What the work throws and nobody waits for is dropped.
template <class Shared>
void do_work(Shared& s, Lock& lock) {
    std::function<void()> work = std::exchange(s.work, nullptr);
    lock.unlock();
    std::exception_ptr error;
    try {
        work();
    } catch (...) {
        error = std::current_exception();
    }
    work = nullptr;
    lock.lock();
    s.busy = s.done = s.waited_for;
    if (s.waited_for) s.error = std::move(error);
    s.changed.notify_all();
    lock.unlock();
    error = nullptr;  // not under the lock: one of Python's takes the GIL
    end_work();
    lock.lock();
}

/// The thread of a worker.
template <class Shared>
void serve(const std::shared_ptr<Shared>& s) {
    works = true;
    Lock lock(s->mutex);
    s->thread = std::this_thread::get_id();
    while (true) {
        s->changed.wait(lock, [&] { return s->closed || s->work; });
        if (!s->work) return;
        do_work(*s, lock);
    }
}

}  // namespace

Worker::Worker() : shared_(std::make_shared<Shared>()) {}

Worker::~Worker() {
    if (is_forked()) return;  // the lock may be held by a thread that is not there
    const std::lock_guard lock(shared_->mutex);
    shared_->closed = true;
    shared_->changed.notify_all();
}

void Worker::claim() {
    Shared& s = *shared_;
    require_threads();
    hear_signals();  // a loop in C, such as that of list(), calls without Python's evaluator
    {
        const std::lock_guard lock(s.mutex);
        const auto own = std::this_thread::get_id();
        if (own == s.thread) throw Error("this object is at work, and its work cannot use it");
        if (own == s.caller)
            throw Error(
                "this object is at work, and a signal's handler that interrupts the call cannot "
                "use it");
    }
    wait_until(s, [&] { return s.busy ? false : (s.busy = true); });
}

void Worker::release() {
    const std::lock_guard lock(shared_->mutex);
    shared_->busy = shared_->waited_for = shared_->done = false;
    shared_->caller = {};
    shared_->changed.notify_all();
}

void Worker::wait() {
    claim();
    release();
}

bool Worker::rests() const {
    if (is_forked()) return false;  // as in the destructor
    const std::lock_guard lock(shared_->mutex);
    return !shared_->busy;
}

void Worker::run(std::function<void()> work, const std::function<void()>& then) {
    Shared& s = *shared_;
    claim();
    try {
        if (!std::exchange(is_started_, true))
            std::thread([shared = shared_] { serve(shared); }).detach();
    } catch (...) {
        is_started_ = false;
        release();
        throw;
    }
    begin_work();
    {
        const std::lock_guard lock(s.mutex);
        s.waited_for = true;
        s.caller = std::this_thread::get_id();
        s.work = std::move(work);
        s.changed.notify_all();
    }
    try {
        wait_until(s, [&] { return s.done; });
    } catch (...) {
        std::exception_ptr lost;  // goes after the lock: one of Python's takes the GIL
        const std::lock_guard lock(s.mutex);
        lost = std::exchange(s.error, nullptr);
        s.waited_for = false;
        s.caller = {};
        if (s.done) s.busy = s.done = false;
        s.changed.notify_all();
        throw;
    }
    const std::exception_ptr error = std::exchange(s.error, nullptr);
    if (then && !error) then();
    release();
    if (error) std::rethrow_exception(error);
}

namespace {

/// Guarded by the GIL. Never destroyed: threads may outlive everything.
std::vector<std::unique_ptr<Worker>>& resting_workers() {
    static auto& only = *new std::vector<std::unique_ptr<Worker>>;
    return only;
}

}  // namespace

std::unique_ptr<Worker> borrow_worker() {
    auto& resting = resting_workers();
    if (resting.empty()) return std::make_unique<Worker>();
    std::unique_ptr<Worker> worker = std::move(resting.back());
    resting.pop_back();
    return worker;
}

void give_back(std::unique_ptr<Worker> worker) { resting_workers().push_back(std::move(worker)); }

CallFromWork::CallFromWork() : worked_before_(std::exchange(works, true)) {}

CallFromWork::~CallFromWork() { works = worked_before_; }

void without_gil(const std::function<void()>& work) {
    // Not one whose end the interpreter waits for, nor one of the functions of its exit.
    const bool may_be_daemon = !works && !process().is_ending;
    const nb::gil_scoped_release without;
    work();
    if (may_be_daemon && process().is_ending) hang();
}

bool is_over(const Flag& is_abandoned) {
    return is_abandoned && (*is_abandoned || process().is_ending);
}

void check_abandoned(const Flag& is_abandoned) {
    if (is_over(is_abandoned)) throw Abandoned{};
}

void end_all_work() {
    if (is_forked()) return;
    process().is_ending = true;
    const nb::gil_scoped_release without;
    Process& p = process();
    Lock lock(p.mutex);
    while (!p.changed.wait_for(lock, kPatience, [&] { return p.working == 0; })) {
        lock.unlock();
        try {
            hear_signals();
        } catch (const nb::python_error&) {
            end_by_signal();
        }
        lock.lock();
    }
}

}  // namespace burnish::python
