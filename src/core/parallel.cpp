#include "core/parallel.h"

#include <algorithm>
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

void parallel_tasks(std::size_t count, const std::function<void(std::size_t)>& body) {
    std::vector<std::exception_ptr> thrown(count);
    parallel_for(count, [&](std::size_t i) {
        try {
            body(i);
        } catch (...) {
            thrown[i] = std::current_exception();
        }
    });
    for (const std::exception_ptr& error : thrown)
        if (error) std::rethrow_exception(error);
}

std::size_t threads_of(int setting) {
    if (setting > 0) return static_cast<std::size_t>(setting);
    return std::max<std::size_t>(1, std::thread::hardware_concurrency());
}

ThreadLimit::ThreadLimit(int threads) : control_(limit_threads(threads_of(threads))) {}
ThreadLimit::~ThreadLimit() { lift_limit(control_); }

}  // namespace burnish
