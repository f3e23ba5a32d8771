// The loops of parallel.h with plain threads in place of TBB, whose synchronisation the thread
// sanitizer does not see. A loop within a loop runs on the thread that meets it.
#include "core/parallel.h"

#ifdef BURNISH_PLAIN_THREADS

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace burnish {

namespace {

std::atomic<std::size_t> max_threads{std::max(1u, std::thread::hardware_concurrency())};
thread_local bool is_in_loop = false;
thread_local const StopQuestion* stop_question = nullptr;  // null: nobody is asked

/// The indices of one loop, which its threads share out.
struct Loop {
    const std::function<void(std::size_t)>& body;
    const StopQuestion* stop;
    std::size_t count;
    std::atomic<std::size_t> next{0};
    std::mutex mutex = {};
    std::exception_ptr error = {};  ///< the first one; guarded by the mutex

    void run() {
        is_in_loop = true;
        try {
            for (std::size_t i; (i = next++) < count;) {
                if (stop && (*stop)()) throw Stopped{};
                body(i);
            }
        } catch (...) {
            const std::lock_guard lock(mutex);
            if (!error) error = std::current_exception();
            next = count;
        }
        is_in_loop = false;
    }
};

}  // namespace

void parallel_chunks(std::size_t count, std::size_t chunk,
                     const std::function<void(std::size_t, std::size_t)>& body) {
    parallel_for((count + chunk - 1) / chunk,
                 [&](std::size_t i) { body(i * chunk, std::min(count, (i + 1) * chunk)); });
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
    if (is_in_loop) {
        for (std::size_t i = 0; i < count; ++i) body(i);
        return;
    }
    Loop loop{body, stop_question, count};
    std::vector<std::thread> threads;
    for (std::size_t t = 1; t < std::min<std::size_t>(max_threads, count); ++t)
        threads.emplace_back([&loop] { loop.run(); });
    loop.run();
    for (std::thread& thread : threads) thread.join();
    if (loop.error) std::rethrow_exception(loop.error);
}

Stoppable::Stoppable(const StopQuestion& stop) : outer_(stop_question) {
    stop_question = stop ? &stop : nullptr;
}
Stoppable::~Stoppable() { stop_question = outer_; }

ThreadLimit::ThreadLimit(int threads) : control_(new std::size_t(max_threads)) {
    max_threads = threads > 0 ? static_cast<std::size_t>(threads)
                              : std::max<std::size_t>(1, std::thread::hardware_concurrency());
}
ThreadLimit::~ThreadLimit() {
    auto* const before = static_cast<std::size_t*>(control_);
    max_threads = *before;
    delete before;
}

}  // namespace burnish

#endif
