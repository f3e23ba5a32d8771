#include "core/parallel.h"

#ifndef BURNISH_PLAIN_THREADS  // those are in parallel_threads.cpp

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <thread>

namespace burnish {

namespace {

thread_local const StopQuestion* stop_question = nullptr;  // null: nobody is asked

void stop_if_asked(const StopQuestion* stop) {
    if (stop && (*stop)()) throw Stopped{};
}

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
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        stop_if_asked(stop);
        body(i);
    });
}

ThreadLimit::ThreadLimit(int threads) {
    const std::size_t n = threads > 0
                              ? static_cast<std::size_t>(threads)
                              : std::max<std::size_t>(1, std::thread::hardware_concurrency());
    control_ = new tbb::global_control(tbb::global_control::max_allowed_parallelism, n);
}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(control_); }

}  // namespace burnish

#endif
