// Texels that no sample visited.
#include "texture/coverage.h"

#include <gtest/gtest.h>

#include <cmath>

namespace burnish {
namespace {

TEST(Unvisited, TakeTheValueOfWhatSurroundsThem) {
    // Left third 0.2, right third 0.8, the middle unknown: monotonous between the two.
    Image texels = make_image(30, 10, 1, 0.5f);
    std::vector<std::uint32_t> visits(300, 0);
    for (int y = 0; y < 10; ++y)
        for (const int x : {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29}) {
            texels.at(x, y, 0) = x < 10 ? 0.2f : 0.8f;
            visits[static_cast<std::size_t>(y * 30 + x)] = 7;
        }
    const Image before = texels;
    fill_unvisited(visits, texels);
    for (int y = 0; y < 10; ++y) {
        for (int x = 0; x < 30; ++x) {
            if (visits[static_cast<std::size_t>(y * 30 + x)] > 0) {
                EXPECT_EQ(texels.at(x, y, 0), before.at(x, y, 0));
            } else {
                EXPECT_GE(texels.at(x, y, 0), 0.2f - 1e-6f);
                EXPECT_LE(texels.at(x, y, 0), 0.8f + 1e-6f);
            }
        }
        EXPECT_LT(texels.at(10, y, 0), 0.4f);
        EXPECT_GT(texels.at(19, y, 0), 0.6f);
    }
}

TEST(Unvisited, AreFilledFromOneTexelOnOddSizesAndInEachChannel) {
    for (const auto& [width, height] : {std::pair{7, 5}, {1, 9}, {16, 3}}) {
        Image texels = make_image(width, height, 3, 0.5f);
        std::vector<std::uint32_t> visits(static_cast<std::size_t>(width * height), 0);
        const int x = width / 2, y = height - 1;
        visits[static_cast<std::size_t>(y * width + x)] = 1;
        for (int c = 0; c < 3; ++c) texels.at(x, y, c) = 0.1f * static_cast<float>(c + 1);
        fill_unvisited(visits, texels);
        for (std::size_t i = 0; i < texels.values.size(); ++i)
            EXPECT_FLOAT_EQ(texels.values[i], 0.1f * static_cast<float>(i % 3 + 1));
    }
}

TEST(Unvisited, StayWhereNothingOrEverythingIsKnown) {
    for (const std::uint32_t count : {0u, 3u}) {
        Image texels = make_image(6, 4, 1, 0.5f);
        texels.at(2, 2, 0) = 0.9f;
        const Image before = texels;
        fill_unvisited(std::vector<std::uint32_t>(24, count), texels);
        EXPECT_EQ(texels.values, before.values);
    }
}

TEST(Unvisited, KeepTheirStartIfAsked) {
    Image texels = make_image(4, 1, 3, 0.9f);
    const Image initial = make_image(4, 1, 3, 0.25f);
    keep_unvisited({0, 1, 0, 5}, initial, texels);
    for (std::size_t i = 0; i < 12; ++i)
        EXPECT_EQ(texels.values[i], (i / 3) % 2 == 0 ? 0.25f : 0.9f);
}

/// Two of three texels are visited: their channels differ by 0.3 and 0.1, the third by 1.
TEST(TextureError, IsTheRootOfTheMeanSquareOverVisitedTexels) {
    Image texels = make_image(3, 1, 3, 0.5f);
    const Image truth = texels;
    for (int c = 0; c < 3; ++c) {
        texels.at(0, 0, c) += 0.3f;
        texels.at(1, 0, c) -= 0.1f;
        texels.at(2, 0, c) += 1.0f;
    }
    EXPECT_NEAR(texture_error(texels, truth, {1, 1, 0}), std::sqrt((0.09 + 0.01) / 2), 1e-6);
    EXPECT_NEAR(texture_error(texels, truth, {0, 1, 0}), 0.1, 1e-6);
    EXPECT_TRUE(std::isnan(texture_error(texels, truth, {0, 0, 0})));
}

}  // namespace
}  // namespace burnish
