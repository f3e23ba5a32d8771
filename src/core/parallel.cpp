#include "core/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

#include "core/flush_denormals.h"
#include "core/parallel_loop.h"

namespace burnish {

namespace {

thread_local const StopQuestion* stop_question = nullptr;  // null: nobody is asked

}  // namespace

Stoppable::Stoppable(const StopQuestion& stop) : outer_(stop_question) {
    stop_question = stop ? &stop : nullptr;
}
Stoppable::~Stoppable() { stop_question = outer_; }

void parallel_chunks(std::size_t count, std::size_t chunk,
                     const std::function<void(std::size_t, std::size_t)>& body) {
    parallel_for((count + chunk - 1) / chunk,
                 [&](std::size_t i) { body(i * chunk, std::min(count, (i + 1) * chunk)); });
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
    const StopQuestion* const stop = stop_question;  // of this thread
    run_loop(count, [&](std::size_t i) {
        if (stop && (*stop)()) throw Stopped{};
        const FlushDenormals flush;
        body(i);
    });
}

namespace {

/// What tasks have thrown, by their number.
struct Thrown {
    std::vector<std::exception_ptr> errors;

    void call(const std::function<void(std::size_t)>& body, std::size_t i) {
        try {
            body(i);
        } catch (...) {
            errors[i] = std::current_exception();
        }
    }
    void rethrow_first() const {
        for (const std::exception_ptr& error : errors)
            if (error) std::rethrow_exception(error);
    }
};

}  // namespace

void parallel_tasks(std::size_t count, const std::function<void(std::size_t)>& body) {
    Thrown thrown{std::vector<std::exception_ptr>(count)};
    parallel_for(count, [&](std::size_t i) { thrown.call(body, i); });
    thrown.rethrow_first();
}

void parallel_tasks(std::size_t count, std::size_t at_once,
                    const std::function<void(std::size_t)>& body) {
    Thrown thrown{std::vector<std::exception_ptr>(count)};
    std::atomic<std::size_t> next{0};
    // Not a task each: a thread that waits in a loop within a task may begin another of these.
    parallel_for(std::min(std::max<std::size_t>(1, at_once), count), [&](std::size_t) {
        for (std::size_t i; (i = next++) < count;) thrown.call(body, i);
    });
    thrown.rethrow_first();
}

std::size_t threads_of(int setting) {
    if (setting > 0) return static_cast<std::size_t>(setting);
    return std::max<std::size_t>(1, std::thread::hardware_concurrency());
}

ThreadLimit::ThreadLimit(int threads) : control_(limit_threads(threads_of(threads))) {}
ThreadLimit::~ThreadLimit() { lift_limit(control_); }

}  // namespace burnish
