// Regions: blocks cut at charts, filled and labelled within them.
#include "texture/regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/parallel.h"
#include "random_source.h"

namespace burnish {
namespace {

/// 12 x 8 texels, two charts whose border lies within blocks of 4 texels, and a column of none.
ChartMap two_charts() {
    ChartMap charts(96);
    for (std::size_t i = 0; i < charts.size(); ++i) charts[i] = i % 12 < 6 ? 1 : 2;
    for (std::size_t y = 0; y < 8; ++y) charts[12 * y + 11] = 0;
    return charts;
}

TEST(Regions, AreBlocksCutAtCharts) {
    const ChartMap charts = two_charts();
    const TextureRegions r = make_regions(charts, 12, 8, 4);
    ASSERT_EQ(r.regions.size(), 8u) << "two rows of blocks of chart 1, of both, and of chart 2";
    for (std::size_t i = 0; i < charts.size(); ++i) {
        const std::uint32_t region = r.of_texel[i];
        ASSERT_EQ(region == TextureRegions::kNone, charts[i] == 0);
        if (charts[i] == 0) continue;
        EXPECT_EQ(r.regions[region],
                  (Region{static_cast<int>(i % 12) / 4, static_cast<int>(i / 12) / 4, charts[i]}));
    }
}

TEST(Regions, CoverTexturesThatBlocksDoNotDivide) {
    const TextureRegions r = make_regions(ChartMap(70, 1), 10, 7, 4);
    ASSERT_EQ(r.regions.size(), 6u);
    for (std::size_t i = 0; i < 70; ++i)
        EXPECT_EQ(r.regions[r.of_texel[i]],
                  (Region{static_cast<int>(i % 10) / 4, static_cast<int>(i / 10) / 4, 1}));
}

/// Charts of single texels left of one: what 8 charts share is cut apart, what 9 share is not.
TEST(Regions, AreNotCutWhereManyChartsMeet) {
    const auto regions_of = [](std::uint32_t count) {
        ChartMap charts(32, 1);  // 8 x 4 texels
        for (std::uint32_t i = 0; i + 1 < count; ++i) charts[8 * (i / 4) + i % 4] = 2 + i;
        charts[24] = 0;
        return make_regions(charts, 8, 4, 4);
    };
    EXPECT_EQ(regions_of(8).regions.size(), 9u);
    const TextureRegions r = regions_of(9);
    EXPECT_EQ(r.regions, (std::vector<Region>{{0, 0, Region::kJoined}, {1, 0, 1}}));
    for (std::size_t i = 0; i < 32; ++i)
        EXPECT_EQ(r.of_texel[i], i == 24 ? TextureRegions::kNone : i % 8 / 4) << i;
    EXPECT_TRUE(neighbours(r, 0).empty());
}

TEST(Regions, HaveNeighboursOfTheirChartAlone) {
    const TextureRegions r = make_regions(two_charts(), 12, 8, 4);
    for (std::uint32_t i = 0; i < r.regions.size(); ++i) {
        const auto found = neighbours(r, i);
        EXPECT_EQ(found.size(), 3u) << "the other three of a chart's 2 x 2";
        for (const std::uint32_t n : found) {
            EXPECT_NE(n, i);
            EXPECT_EQ(r.regions[n].chart, r.regions[i].chart);
        }
    }
}

TEST(Regions, AreFilledFromTheirChart) {
    const TextureRegions r = make_regions(two_charts(), 12, 8, 4);
    std::vector<char> known(r.regions.size(), 0);
    std::vector<float> values(r.regions.size(), -1);
    fill_regions(r, known, 0.5f, values);
    EXPECT_EQ(values, std::vector<float>(r.regions.size(), 0.5f)) << "nothing is known";

    for (std::uint32_t i = 0; i < r.regions.size(); ++i)
        if (r.regions[i].chart == 1 && r.regions[i].x == 0)
            known[i] = 1, values[i] = r.regions[i].y == 0 ? 0.25f : 0.75f;
    fill_regions(r, known, 0.5f, values);
    for (std::uint32_t i = 0; i < r.regions.size(); ++i)
        EXPECT_TRUE(known[i] || values[i] == 0.5f) << "the mean of both";

    for (std::uint32_t i = 0; i < r.regions.size(); ++i)
        known[i] = r.regions[i].chart == 2, values[i] = known[i] ? 0.1f : -1;
    fill_regions(r, known, 0.5f, values);
    EXPECT_EQ(values, std::vector<float>(r.regions.size(), 0.1f))
        << "nothing of chart 1 is known: the mean of all that is";

    const ChartMap apart(16, 1);
    const TextureRegions row = make_regions(apart, 16, 1, 4);
    std::vector<float> of_row{0.2f, -1, -1, -1};
    fill_regions(row, {1, 0, 0, 0}, 0.5f, of_row);
    EXPECT_EQ(of_row, std::vector<float>(4, 0.2f)) << "ring by ring";
}

constexpr std::size_t kLabels = 3;

/// Costs and distances of so many regions.
struct Field {
    std::vector<float> costs, distance;
};

Field random_field(std::size_t regions, float scale) {
    test::RandomSource random{31};
    Field f;
    for (std::size_t i = 0; i < regions * kLabels; ++i) f.costs.push_back(random.next(0, 1));
    for (std::size_t a = 0; a < kLabels; ++a)
        for (std::size_t b = 0; b < kLabels; ++b)
            f.distance.push_back(scale * std::abs(static_cast<float>(a) - static_cast<float>(b)));
    return f;
}

/// In a row of regions belief propagation is exact: the least of all assignments.
TEST(RegionLabels, AreTheBestOfARow) {
    constexpr std::size_t kRow = 7;
    const TextureRegions r = make_regions(ChartMap(kRow, 1), kRow, 1, 1);
    for (const float scale : {0.0f, 0.2f, 0.6f, 5.0f}) {
        const Field f = random_field(kRow, scale);
        std::vector<std::uint32_t> best;
        float min = 1e9f;
        for (std::uint32_t code = 0; code < 2187; ++code) {  // 3^7
            std::vector<std::uint32_t> labels;
            for (std::uint32_t rest = code; labels.size() < kRow; rest /= kLabels)
                labels.push_back(rest % kLabels);
            float sum = 0;
            for (std::size_t i = 0; i < kRow; ++i) {
                sum += f.costs[i * kLabels + labels[i]];
                if (i > 0) sum += f.distance[labels[i - 1] * kLabels + labels[i]];
            }
            if (sum < min) min = sum, best = labels;
        }
        EXPECT_EQ(label_regions(r, std::vector<char>(kRow, 1), f.costs, f.distance), best) << scale;
    }
}

TEST(RegionLabels, DoNotReachAcrossCharts) {
    const TextureRegions r = make_regions(two_charts(), 12, 8, 4);
    // Chart 1 is sure of label 0, chart 2 has a slight wish for label 2.
    std::vector<float> costs;
    for (const Region& region : r.regions)
        for (const float c :
             region.chart == 1 ? std::array{0.0f, 9.0f, 9.0f} : std::array{0.01f, 0.01f, 0.0f})
            costs.push_back(c);
    const Field f = random_field(1, 1);
    const auto labels = label_regions(r, std::vector<char>(8, 1), costs, f.distance);
    for (std::size_t i = 0; i < labels.size(); ++i)
        EXPECT_EQ(labels[i], r.regions[i].chart == 1 ? 0u : 2u);
}

TEST(RegionLabels, AreTheSameForAnyNumberOfThreads) {
    const TextureRegions r = make_regions(ChartMap(1600, 1), 40, 40, 1);
    const Field f = random_field(1600, 0.2f);
    std::vector<char> present(1600, 1);
    for (std::size_t i = 0; i < present.size(); i += 7) present[i] = 0;
    std::set<std::vector<std::uint32_t>> found;
    for (int threads = 1; threads <= 5; ++threads) {
        const ThreadLimit limit(threads);
        found.insert(label_regions(r, present, f.costs, f.distance));
    }
    EXPECT_EQ(found.size(), 1u);
    for (std::size_t i = 0; i < present.size(); i += 7) EXPECT_EQ((*found.begin())[i], 0u);
}

/// Regions of a kind agree; the border between kinds stands where no cost says so.
TEST(Regions, AgreeWithThoseOfTheirKind) {
    const TextureRegions r = make_regions(ChartMap(8 * 24, 1), 24, 8, 4);
    const std::vector<char> present(r.regions.size(), 1);
    std::vector<float> costs(2 * r.regions.size(), 0.0f);
    std::vector<std::uint32_t> kinds;
    for (std::size_t i = 0; i < r.regions.size(); ++i) kinds.push_back(r.regions[i].x < 4 ? 0 : 1);
    for (std::size_t i = 0; i < r.regions.size(); ++i)
        if (r.regions[i].x == 0 || r.regions[i].x == 5) costs[2 * i + (kinds[i] == 0 ? 1 : 0)] = 9;
    const std::vector<float> distance{0, 1.5f, 1.5f, 0};
    EXPECT_EQ(label_regions(r, present, costs, distance, kinds), kinds);
}

}  // namespace
}  // namespace burnish
