// Work that takes time, for Python: it is done by another thread, without the GIL, while the
// thread that called waits and hears signals. Ctrl-C ends the waiting at once; the work itself ends
// at the next call of its progress, or is taken up by the next call of its object.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>

#include "burnish/renderer.h"

namespace burnish::python {

/// Between looks for what ends a wait: signals, and that nobody waits for the work any more.
inline constexpr auto kPatience = std::chrono::milliseconds(50);

/// Ends work that nobody waits for.
struct Abandoned {};

/// A thread that does one piece of work at a time. It starts with the first one.
class Worker {
  public:
    Worker();
    ~Worker();
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    /// Does the work and waits for it; to be called with the GIL. Waits first for the work of an
    /// earlier call. Throws what the work throws; nb::python_error where a signal handler raises:
    /// before the work begins, or else it goes on, and what it throws is lost. The work must own
    /// what it uses. Throws Error where the work itself calls this, or a signal handler while this
    /// waits; and in a process that was forked after the first work. then: called here once the
    /// work has ended, before another call's work begins.
    void run(std::function<void()> work, const std::function<void()>& then = {});

    /// Waits for the work that an interrupted call has left behind.
    void wait();

    /// Whether no work goes on, and there are threads to begin one.
    bool rests() const;

  private:
    struct Shared;
    void claim();
    void release();
    std::shared_ptr<Shared> shared_;
    bool is_started_ = false;
};

/// A worker that rests, for a call without an object of its own; a thread for each call would cost
/// memory that oneTBB keeps. To be called with the GIL, as give_back.
std::unique_ptr<Worker> borrow_worker();
/// worker: it rests.
void give_back(std::unique_ptr<Worker> worker);

/// The GIL for a function of Python that work calls, on a worker's thread or one of oneTBB: the end
/// of the interpreter waits for that work, and so for what the function begins.
class CallFromWork {
  public:
    CallFromWork();
    ~CallFromWork();
    CallFromWork(const CallFromWork&) = delete;
    CallFromWork& operator=(const CallFromWork&) = delete;

  private:
    nanobind::gil_scoped_acquire gil_;
    bool worked_before_;
};

/// Before the interpreter ends: gives up all work that goes on, and waits for it. A signal whose
/// handler raises meanwhile, as Ctrl-C does, ends the process at once: the work may not return.
void end_all_work();

/// Does work on this thread, without the GIL; signals wait for its end. For what takes a second at
/// most: it needs no thread, and so may be done in a process that was forked.
void without_gil(const std::function<void()>& work);

/// Whether nobody waits for the work.
using Flag = std::shared_ptr<std::atomic<bool>>;
/// Whether that is so, or the interpreter ends. Null: never.
bool is_over(const Flag& is_abandoned);
/// Throws Abandoned where it is.
void check_abandoned(const Flag& is_abandoned);

/// Calls body(const Flag& is_abandoned) on another thread and returns what it returns.
template <class Body>
auto compute(Body body) {
    using Result = std::invoke_result_t<Body, const Flag&>;
    struct Call {
        Body body;
        std::optional<Result> result = {};
        Flag is_abandoned = std::make_shared<std::atomic<bool>>(false);
    };
    auto call = std::make_shared<Call>(Call{std::move(body)});
    std::unique_ptr<Worker> worker = borrow_worker();
    try {
        worker->run([call] { call->result.emplace(call->body(call->is_abandoned)); });
    } catch (...) {
        *call->is_abandoned = true;
        if (worker->rests()) give_back(std::move(worker));
        throw;
    }
    give_back(std::move(worker));
    return std::move(*call->result);
}

/// Progress that ends abandoned work.
inline Progress progress_of(const Flag& is_abandoned) {
    return [is_abandoned](double) { check_abandoned(is_abandoned); };
}

}  // namespace burnish::python
