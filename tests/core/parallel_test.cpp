#include "core/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "error_of.h"

namespace burnish {
namespace {

/// 2^-120 times 2^-20, by the processor.
float tiny() {
    volatile float a = 0x1p-120f, b = 0x1p-20f;
    return a * b;
}

std::vector<float> tiny_in_a_loop() {
    std::vector<float> found(1000, -1.0f);
    parallel_for(found.size(), [&](std::size_t i) { found[i] = tiny(); });
    return found;
}

/// Whichever thread starts a loop, and whichever runs it.
TEST(Parallel, LoopsFlushDenormals) {
    const std::vector<float> zeros(1000, 0.0f);
    EXPECT_EQ(tiny_in_a_loop(), zeros);
    std::vector<float> of_thread;
    std::thread([&] { of_thread = tiny_in_a_loop(); }).join();
    EXPECT_EQ(of_thread, zeros);
}

TEST(Parallel, WhoStartsALoopKeepsDenormals) {
    tiny_in_a_loop();
    EXPECT_GT(tiny(), 0);
    EXPECT_THROW(parallel_for(2, [](std::size_t) { throw Stopped{}; }), Stopped);
    EXPECT_GT(tiny(), 0);
}

/// The others are done all the same.
TEST(Parallel, TasksThrowWhatTheFirstOfThemThrew) {
    for (int repetition = 0; repetition < 20; ++repetition) {
        std::vector<int> done(64, 0);
        const auto run = [&] {
            parallel_tasks(done.size(), [&](std::size_t i) {
                if (i % 20 == 7) throw std::runtime_error(std::to_string(i));
                done[i] = 1;
            });
        };
        EXPECT_EQ(test::error_of<std::runtime_error>(run), "7");
        EXPECT_EQ(std::count(done.begin(), done.end(), 1), 61);
    }
}

/// Also where a task has a loop in it, in which a thread may begin another task while it waits.
TEST(Parallel, TasksAreAtMostSoManyAtATime) {
    for (const std::size_t at_once : {1u, 2u, 100u}) {
        std::vector<int> done(40, 0);
        std::mutex mutex;
        std::size_t begun = 0, max = 0;
        const auto count = [&](int change) {
            const std::lock_guard lock(mutex);
            begun += static_cast<std::size_t>(change);
            max = std::max(max, begun);
        };
        const auto run = [&] {
            parallel_tasks(done.size(), at_once, [&](std::size_t i) {
                count(1);
                tiny_in_a_loop();
                done[i] = 1;
                count(-1);
                if (i % 20 == 7) throw std::runtime_error(std::to_string(i));
            });
        };
        EXPECT_EQ(test::error_of<std::runtime_error>(run), "7");
        EXPECT_EQ(std::count(done.begin(), done.end(), 1), 40);
        EXPECT_LE(max, at_once);
    }
}

}  // namespace
}  // namespace burnish
