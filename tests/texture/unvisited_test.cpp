// Texels that no sample visited.
#include "texture/unvisited.h"

#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

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
    fill_unvisited(visits, {}, false, texels);
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

/// Between known rows, or columns, the values of the others lie in order, alike in both directions.
TEST(Unvisited, RiseFromOneSideToTheOther) {
    std::array<std::vector<float>, 2> profiles;
    for (const bool down : {false, true}) {
        const int width = down ? 10 : 30, height = down ? 30 : 10;
        Image texels = make_image(width, height, 1, 0.5f);
        std::vector<std::uint32_t> visits(300, 0);
        const auto along = [&](int x, int y) { return down ? y : x; };
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                if (const int at = along(x, y); at < 10 || at >= 20) {
                    texels.at(x, y, 0) = at < 10 ? 0.2f : 0.8f;
                    visits[static_cast<std::size_t>(y * width + x)] = 1;
                }
        fill_unvisited(visits, {}, false, texels);
        for (int i = 0; i < 30; ++i) {
            const int x = down ? 4 : i, y = down ? i : 4;
            profiles[down].push_back(texels.at(x, y, 0));
            if (i == 0) continue;
            EXPECT_GE(profiles[down].back(), profiles[down].end()[-2] - 1e-6f) << down << " " << i;
        }
    }
    for (std::size_t i = 0; i < 30; ++i) EXPECT_NEAR(profiles[0][i], profiles[1][i], 1e-6f) << i;
}

TEST(Unvisited, AreFilledFromOneTexelOnOddSizesAndInEachChannel) {
    for (const auto& [width, height] : {std::pair{7, 5}, {1, 9}, {16, 3}}) {
        Image texels = make_image(width, height, 3, 0.5f);
        std::vector<std::uint32_t> visits(static_cast<std::size_t>(width * height), 0);
        const int x = width / 2, y = height - 1;
        visits[static_cast<std::size_t>(y * width + x)] = 1;
        for (int c = 0; c < 3; ++c) texels.at(x, y, c) = 0.1f * static_cast<float>(c + 1);
        fill_unvisited(visits, {}, false, texels);
        for (std::size_t i = 0; i < texels.values.size(); ++i)
            EXPECT_FLOAT_EQ(texels.values[i], 0.1f * static_cast<float>(i % 3 + 1));
    }
}

/// Columns left of `border` are one chart, the others another; columns from 2 to there are unknown.
void expect_own_charts(std::size_t border) {
    Image texels = make_image(16, 8, 1, 0.5f);
    ChartMap charts(128);
    std::vector<std::uint32_t> visits(128, 0);
    for (std::size_t i = 0; i < 128; ++i) {
        const std::size_t x = i % 16;
        charts[i] = x < border ? 1 : 2;
        visits[i] = x < 2 || x >= border;
        if (visits[i]) texels.values[i] = x < border ? 0.2f : 0.8f;
    }
    fill_unvisited(visits, charts, false, texels);
    for (std::size_t i = 0; i < 128; ++i)
        EXPECT_FLOAT_EQ(texels.values[i], i % 16 < border ? 0.2f : 0.8f) << i;
}

/// The unknown texels lie nearer to the known ones of the other chart.
TEST(Unvisited, AreFilledFromTheirOwnChart) { expect_own_charts(8); }

/// The border of two charts lies within texels of the coarser levels: none of them mixes the two.
TEST(Unvisited, AreFilledFromTheirOwnChartWhereCoarseTexelsHoldTwo) { expect_own_charts(7); }

TEST(Unvisited, AreCountedWhereASurfaceReadsThem) {
    EXPECT_EQ(count_unvisited({0, 0, 3, 0, 1}, {0, 1, 1, 2, 0}), 2u);
}

/// Charts 1 and 2 alternate from column to column, chart 3 is one texel of which nothing is known:
/// it takes what is around it.
TEST(Unvisited, OfAChartWithoutAnyKnownTexelAreFilledFromTheOthers) {
    Image texels = make_image(8, 8, 3, 0.5f);
    ChartMap charts(64);
    std::vector<std::uint32_t> visits(64, 1);
    for (std::size_t i = 0; i < 64; ++i) {
        charts[i] = 1 + i % 2;
        for (std::size_t c = 0; c < 3; ++c) texels.values[3 * i + c] = i % 2 == 0 ? 0.2f : 0.6f;
    }
    charts[27] = 3, visits[27] = 0;
    fill_unvisited(visits, charts, false, texels);
    EXPECT_GE(texels.values[3 * 27], 0.2f);
    EXPECT_LE(texels.values[3 * 27], 0.6f);
    EXPECT_NE(texels.values[3 * 27], 0.5f);
    EXPECT_FLOAT_EQ(texels.values[3 * 28], 0.2f);
}

/// Charts of columns 2 to 6 and 13 to 17, a gap of six between them, and one of four over the
/// borders of what repeats.
TEST(Unvisited, OfNoChartTakeTheValueOfTheNearestChart) {
    constexpr int kWidth = 20, kHeight = 6;
    for (const bool repeats : {false, true}) {
        Image texels = make_image(kWidth, kHeight, 3, 0.5f);
        ChartMap charts(kWidth * kHeight);
        std::vector<std::uint32_t> visits(charts.size());
        for (std::size_t i = 0; i < charts.size(); ++i) {
            const std::size_t x = i % kWidth;
            charts[i] = x >= 2 && x <= 6 ? 1 : x >= 13 && x <= 17 ? 2 : 0;
            visits[i] = charts[i] > 0;
            for (std::size_t c = 0; c < 3 && visits[i]; ++c)
                texels.values[3 * i + c] = charts[i] == 1 ? 0.1f : 0.7f;
        }
        fill_unvisited(visits, charts, repeats, texels);
        for (std::size_t i = 0; i < texels.values.size(); ++i)
            EXPECT_EQ(texels.values[i], i / 3 % kWidth < 10 ? 0.1f : 0.7f) << i / 3 % kWidth;
    }
}

/// One chart of columns 1 to 3 at the left border, one of columns 5 and 6, in a texture of 12.
TEST(Unvisited, OfNoChartLookOverTheBordersOfWhatRepeats) {
    for (const bool repeats : {false, true}) {
        Image texels = make_image(12, 4, 1, 0.5f);
        ChartMap charts(48);
        std::vector<std::uint32_t> visits(48);
        for (std::size_t i = 0; i < 48; ++i) {
            const std::size_t x = i % 12;
            charts[i] = x >= 1 && x <= 3 ? 1 : x == 5 || x == 6 ? 2 : 0;
            visits[i] = charts[i] > 0;
            if (visits[i]) texels.values[i] = charts[i] == 1 ? 0.1f : 0.7f;
        }
        fill_unvisited(visits, charts, repeats, texels);
        for (std::size_t y = 0; y < 4; ++y) {
            EXPECT_EQ(texels.values[12 * y], 0.1f);
            EXPECT_EQ(texels.values[12 * y + 8], 0.7f);
            EXPECT_EQ(texels.values[12 * y + 11], repeats ? 0.1f : 0.7f);
        }
    }
}

/// A row, or column, whose first texel is unknown: those beside it are 0, those at the other end 1.
TEST(Unvisited, AreFilledFromBothSidesOfTheBorderOfWhatRepeats) {
    for (const bool has_charts : {false, true})
        for (const bool down : {false, true})
            for (const bool repeats : {false, true}) {
                Image texels = make_image(down ? 1 : 16, down ? 16 : 1, 1, 0.5f);
                std::vector<std::uint32_t> visits(16, 1);
                visits[0] = 0;
                for (std::size_t i = 1; i < 16; ++i) texels.values[i] = i < 8 ? 0.0f : 1.0f;
                fill_unvisited(visits, ChartMap(has_charts ? 16 : 0, 1), repeats, texels);
                EXPECT_EQ(texels.values[0] > 0, repeats) << has_charts << " " << down;
            }
}

TEST(Unvisited, StayWhereNothingOrEverythingIsKnown) {
    for (const std::uint32_t count : {0u, 3u}) {
        Image texels = make_image(6, 4, 1, 0.5f);
        texels.at(2, 2, 0) = 0.9f;
        const Image before = texels;
        fill_unvisited(std::vector<std::uint32_t>(24, count), {}, false, texels);
        EXPECT_EQ(texels.values, before.values);
    }
}

TEST(Unvisited, KeepTheirStartIfAsked) {
    Image texels = make_image(4, 1, 3, 0.9f);
    const std::vector<float> initial(12, 0.25f);
    keep_unvisited({0, 1, 0, 5}, initial, texels);
    for (std::size_t i = 0; i < 12; ++i)
        EXPECT_EQ(texels.values[i], (i / 3) % 2 == 0 ? 0.25f : 0.9f);
}

}  // namespace
}  // namespace burnish
