// What a progress function hears of a render, and may do meanwhile.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "gradient/small_scene.h"
#include "render/renderer.h"

namespace burnish {
namespace {

Renderer renderer_of(int side) {
    Scene scene = test::make_small_scene();
    scene.film.width = scene.film.height = scene.film.crop_width = scene.film.crop_height = side;
    return make_renderer(std::move(scene));
}

TEST(Progress, GrowsToTheWhole) {
    std::vector<double> told;
    renderer_of(64).render(40, 0, {}, [&](double share) { told.push_back(share); });
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    EXPECT_EQ(std::adjacent_find(told.begin(), told.end()), told.end());
    ASSERT_FALSE(told.empty());
    EXPECT_GT(told.front(), 0);
    EXPECT_EQ(told.back(), 1);
}

/// One that waited would wait for itself where a loop of the call takes up tiles that are left.
TEST(Progress, NoThreadWaitsForACall) {
    if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one thread alone";
    constexpr int kTiles = 1024;
    const Renderer renderer = renderer_of(512);
    const ThreadLimit two(2);
    std::atomic<int> begun = 0;
    const StopQuestion count = [&] { return ++begun < 0; };
    const Stoppable counted(count);
    bool is_first = true, went_on = false;
    renderer.render(1, 0, {}, [&](double) {
        if (!std::exchange(is_first, false)) return;
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
        while (!went_on && std::chrono::steady_clock::now() < end) {
            went_on = begun > kTiles / 8;
            std::this_thread::yield();
        }
    });
    EXPECT_TRUE(went_on) << begun;
}

TEST(Progress, MayRender) {
    const Renderer renderer = renderer_of(96);
    const Image expected = renderer.render(4);
    std::vector<Image> within;
    const Image image =
        renderer.render(4, 0, {}, [&](double) { within.push_back(renderer.render(4)); });
    EXPECT_EQ(image, expected);
    ASSERT_FALSE(within.empty());
    for (const Image& i : within) EXPECT_EQ(i, expected);
}

}  // namespace
}  // namespace burnish
