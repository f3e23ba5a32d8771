// Plain threads. A loop within a loop runs on the thread that meets it.
#include "core/parallel_loop.h"

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

/// The indices of one loop, which its threads share out.
struct Loop {
    const std::function<void(std::size_t)>& body;
    std::size_t count;
    std::atomic<std::size_t> next{0};
    std::mutex mutex = {};
    std::exception_ptr error = {};  ///< the first one; guarded by the mutex

    void run() {
        is_in_loop = true;
        try {
            for (std::size_t i; (i = next++) < count;) body(i);
        } catch (...) {
            const std::lock_guard lock(mutex);
            if (!error) error = std::current_exception();
            next = count;
        }
        is_in_loop = false;
    }
};

}  // namespace

void run_loop(std::size_t count, const std::function<void(std::size_t)>& body) {
    if (is_in_loop) {
        for (std::size_t i = 0; i < count; ++i) body(i);
        return;
    }
    Loop loop{body, count};
    std::vector<std::thread> threads;
    for (std::size_t t = 1; t < std::min<std::size_t>(max_threads, count); ++t)
        threads.emplace_back([&loop] { loop.run(); });
    loop.run();
    for (std::thread& thread : threads) thread.join();
    if (loop.error) std::rethrow_exception(loop.error);
}

void* limit_threads(std::size_t threads) { return new std::size_t(max_threads.exchange(threads)); }
void lift_limit(void* limit) {
    auto* const before = static_cast<std::size_t*>(limit);
    max_threads = *before;
    delete before;
}

}  // namespace burnish

#endif
