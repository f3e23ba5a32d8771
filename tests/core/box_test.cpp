#include "core/box.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/transform.h"

namespace burnish {
namespace {

TEST(Box, HoldsWhatItIncludes) {
    Box box;
    EXPECT_TRUE(box.empty());
    box.include(Vec3f{1, -2, 3});
    EXPECT_FALSE(box.empty());
    EXPECT_EQ(box.size(), Vec3f{});
    box.include(Vec3f{-1, 4, 3});
    EXPECT_EQ(box.low, (Vec3f{-1, -2, 3}));
    EXPECT_EQ(box.high, (Vec3f{1, 4, 3}));
    EXPECT_EQ(box.center(), (Vec3f{0, 1, 3}));
    EXPECT_EQ(box.size(), (Vec3f{2, 6, 0}));
    box.include(Box{});
    EXPECT_EQ(box.size(), (Vec3f{2, 6, 0})) << "an empty box adds nothing";
    box.include(Box{{0, 0, 0}, {0, 0, 9}});
    EXPECT_EQ(box.high, (Vec3f{1, 4, 9}));
}

TEST(Box, IsAroundItsTransformedCorners) {
    const Transform turned = translation({1, 0, 0}) * rotation({0, 0, 1}, 45) * scaling({2, 2, 1});
    const Box box = transform_box(turned, Box{{-1, -1, 3}, {1, 1, 4}});
    const float reach = std::sqrt(8.0f);
    EXPECT_NEAR(box.low.x, 1 - reach, 1e-6f);
    EXPECT_NEAR(box.high.x, 1 + reach, 1e-6f);
    EXPECT_NEAR(box.low.y, -reach, 1e-6f);
    EXPECT_NEAR(box.high.y, reach, 1e-6f);
    EXPECT_EQ(box.low.z, 3);
    EXPECT_EQ(box.high.z, 4);
    EXPECT_TRUE(transform_box(turned, {}).empty());
}

}  // namespace
}  // namespace burnish
