#include "core/box.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace burnish
