// Pyramids: what is encoded comes back, charts and repeating textures are honoured. One level is
// the texture itself.
#include "texture/pyramid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "texture/pyramid_run.h"

namespace burnish {
namespace {

using namespace test;

TEST(Pyramid, DecodesWhatWasEncodedExactly) {
    for (const int levels : {1, 20})
        for (const auto& [width, height] : {std::pair{8, 8}, {7, 5}, {1, 9}, {1, 1}}) {
            const Image texture = random_image(width, height, 3, 0, 1, 21);
            EXPECT_EQ(decode(make_run(levels, texture)).values, texture.values)
                << width << " x " << height;
        }
}

TEST(Pyramid, HalvesDownToOneTexel) {
    const PyramidRun run = make_run(20, make_image(10, 3, 1, 0.5f));
    std::vector<std::pair<int, int>> sizes;
    for (const LevelState& level : run.state.levels)
        sizes.emplace_back(level.values.width, level.values.height);
    EXPECT_EQ(sizes, (std::vector<std::pair<int, int>>{{10, 3}, {5, 2}, {3, 1}, {2, 1}, {1, 1}}));
}

/// A coarse level at a fine texel: bilinear between texel centres, clamped at the border.
double bilinear(const Image& coarse, int x, int y, int c) {
    const double px = (x + 0.5) / 2 - 0.5, py = (y + 0.5) / 2 - 0.5;
    double sum = 0;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const double cx = std::floor(px) + i, cy = std::floor(py) + j;
            const double weight = (1 - std::abs(px - cx)) * (1 - std::abs(py - cy));
            sum += weight *
                   double{coarse.at(std::clamp(static_cast<int>(cx), 0, coarse.width - 1),
                                    std::clamp(static_cast<int>(cy), 0, coarse.height - 1), c)};
        }
    return sum;
}

TEST(Pyramid, InterpolatesBetweenTexelCentres) {
    for (const int channels : {1, 3})
        for (const auto& [width, height] :
             {std::pair{130, 101}, {7, 5}, {2, 9}, {1, 3}, {16, 1}, {5000, 3}}) {
            PyramidRun run = make_run(2, random_image(width, height, channels, 0, 0.4f, 51));
            Image& coarse = run.state.levels[1].values;
            coarse = random_image(coarse.width, coarse.height, channels, 0, 0.4f, 52);
            const Image texture = decode(run);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x)
                    for (int c = 0; c < channels; ++c)
                        ASSERT_NEAR(double{texture.at(x, y, c)},
                                    double{run.state.levels[0].values.at(x, y, c)} +
                                        bilinear(coarse, x, y, c),
                                    1e-6)
                            << width << " x " << height << ": " << x << ", " << y;
        }
}

TEST(Pyramid, ProlongsByItsWeights) {
    const int width = 11, height = 7;
    for (const bool repeats : {false, true}) {
        PyramidRun run = make_run(2, make_image(width, height, 1), {}, repeats);
        run.state.levels[1].values.at(0, 2, 0) = 1;
        const Image texture = decode(run);
        const auto along = [&](int i, int size, int coarse) {
            const int near = i / 2, next = near + (i % 2 == 0 ? -1 : 1), last = (size - 1) / 2;
            const int far =
                repeats ? (next + last + 1) % (last + 1) : std::min(std::max(next, 0), last);
            return (near == coarse ? 0.75f : 0.0f) + (far == coarse ? 0.25f : 0.0f);
        };
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                EXPECT_FLOAT_EQ(texture.at(x, y, 0), along(x, width, 0) * along(y, height, 2));
    }
}

/// Evidence at one border of a texture that repeats moves the other border, and only then.
TEST(Pyramid, GoesRoundWhereATextureRepeats) {
    for (const bool repeats : {false, true}) {
        PyramidRun run = make_run(3, make_image(32, 32, 1, 0.5f), {}, repeats);
        run.adam.learning_rate = 0.05f;
        Image texture = decode(run), gradient = make_image(32, 32, 1);
        for (int y = 0; y < 32; ++y) gradient.at(0, y, 0) = 1;
        for (int i = 0; i < 3; ++i) descend({gradient, {}}, run, texture);
        EXPECT_EQ(texture.at(31, 9, 0) < 0.5f, repeats);
        EXPECT_EQ(texture.at(16, 9, 0), 0.5f);
    }
}

/// A constant coarse level is constant on every texel that reads any of it, and each chart reads
/// its own texels alone.
TEST(Pyramid, ReadsWithinChartsAlone) {
    const int width = 60, height = 41;
    const ChartMap charts = random_charts(width, height, 82);
    const PyramidRun base = make_run(2, make_image(width, height, 1), charts);
    std::vector<std::uint32_t> reads(charts.size(), 0);
    for (std::size_t k = 0; k < base.state.levels[1].values.values.size(); ++k) {
        PyramidRun run = base;
        run.state.levels[1].values.values[k] = 0.5f;
        const Image texture = decode(run);
        std::uint32_t seen = 0;
        for (std::size_t i = 0; i < charts.size(); ++i) {
            if (texture.values[i] == 0 || charts[i] == 0) continue;
            if (seen == 0) seen = charts[i];
            EXPECT_EQ(charts[i], seen);
            reads[i] = 1;
        }
    }
    PyramidRun all = base;
    std::vector<float>& coarse = all.state.levels[1].values.values;
    std::fill(coarse.begin(), coarse.end(), 0.5f);
    const Image texture = decode(all);
    std::size_t alone = 0;
    for (std::size_t i = 0; i < charts.size(); ++i) {
        if (charts[i] == 0) continue;
        EXPECT_NEAR(texture.values[i], reads[i] ? 0.5f : 0.0f, 1e-6f);
        alone += !reads[i];
    }
    EXPECT_GT(alone, 0u) << "a test of islands that are too small to be heard";
    EXPECT_LT(alone, charts.size() / 10);
}

TEST(Pyramid, SharesNothingBetweenCharts) {
    const int width = 37, height = 18;
    PyramidRun run = make_run(5, make_image(width, height, 1, 0.5f), two_charts(width, height));
    run.adam.learning_rate = 0.05f;
    Image texture = decode(run), gradient = make_image(width, height, 1);
    for (int y = 0; y < height; ++y) gradient.at(width / 2 - 1, y, 0) = 1;
    for (int i = 0; i < 5; ++i) descend({gradient, {}}, run, texture);
    EXPECT_LT(texture.at(width / 2 - 3, 4, 0), 0.45f);
    for (int x = width / 2 + 1; x < width; ++x)
        for (int y = 0; y < height; ++y) EXPECT_EQ(texture.at(x, y, 0), 0.5f) << x << ", " << y;
}

}  // namespace
}  // namespace burnish
