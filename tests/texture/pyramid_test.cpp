// Parameterisations: what is encoded comes back, and the gradient goes through the transposed map.
#include "texture/pyramid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "random_source.h"

namespace burnish {
namespace {

Image random_image(int width, int height, int channels, float low, float high, std::uint32_t seed) {
    test::RandomSource random{seed};
    Image image = make_image(width, height, channels);
    for (float& v : image.values) v = random.next(low, high);
    return image;
}

/// Two charts, left and right, with a column of no chart between them.
ChartMap two_charts(int width, int height) {
    ChartMap charts;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            charts.push_back(x < width / 2 ? 1u : x == width / 2 ? 0u : 2u);
    return charts;
}

/// Many small charts that touch, holes, and islands of a single texel.
ChartMap random_charts(int width, int height, std::uint32_t seed) {
    test::RandomSource random{seed};
    std::vector<std::uint32_t> blocks;
    for (int i = 0; i < width * height; ++i)
        blocks.push_back(static_cast<std::uint32_t>(random.next(0.0f, 4.0f)));
    ChartMap charts;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            charts.push_back((y * width + x) % 97 == 5
                                 ? 4
                                 : blocks[static_cast<std::size_t>((y / 3) * width + x / 5)]);
    return charts;
}

double dot(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i)
        sum += double{a.values[i]} * double{b.values[i]};
    return sum;
}

TEST(Parameterization, DecodesWhatWasEncodedExactly) {
    for (const auto kind :
         {Parameterization::kTexels, Parameterization::kPyramid, Parameterization::kSmooth})
        for (const auto& [width, height] : {std::pair{8, 8}, {7, 5}, {1, 9}, {1, 1}}) {
            const Image texture = random_image(width, height, 3, 0, 1, 21);
            EXPECT_EQ(decode(encode({kind, 20}, texture)).values, texture.values)
                << width << " x " << height;
        }
}

TEST(Parameterization, PyramidHalvesDownToOneTexel) {
    const TextureParameters p =
        encode({Parameterization::kPyramid, 20}, make_image(10, 3, 1, 0.5f));
    std::vector<std::pair<int, int>> sizes;
    for (const LevelState& level : p.levels)
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

TEST(Parameterization, PyramidInterpolatesBetweenTexelCentres) {
    for (const int channels : {1, 3})
        for (const auto& [width, height] :
             {std::pair{130, 101}, {7, 5}, {2, 9}, {1, 3}, {16, 1}, {5000, 3}}) {
            TextureParameters p = encode({Parameterization::kPyramid, 2},
                                         random_image(width, height, channels, 0, 0.4f, 51));
            Image& coarse = p.levels[1].values;
            coarse = random_image(coarse.width, coarse.height, channels, 0, 0.4f, 52);
            const Image texture = decode(p);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x)
                    for (int c = 0; c < channels; ++c)
                        ASSERT_NEAR(
                            double{texture.at(x, y, c)},
                            double{p.levels[0].values.at(x, y, c)} + bilinear(coarse, x, y, c),
                            1e-6)
                            << width << " x " << height << ": " << x << ", " << y;
        }
}

/// Adds x to the levels, and returns the texture's change: decode is linear inside its range.
Image decode_change(const TextureParameters& base, const std::vector<Image>& x) {
    TextureParameters moved = base;
    for (std::size_t i = 0; i < x.size(); ++i)
        for (std::size_t k = 0; k < x[i].values.size(); ++k)
            moved.levels[i].values.values[k] += x[i].values[k];
    Image change = decode(moved);
    const Image before = decode(base);
    for (std::size_t k = 0; k < change.values.size(); ++k) change.values[k] -= before.values[k];
    return change;
}

/// The gradient by the levels that descend() steps along: SGD of rate 1 moves by exactly that.
std::vector<Image> level_gradients(const TextureParameters& base, const Image& gradient) {
    OptimizerOptions options;
    options.kind = Optimizer::kSgd;
    options.learning_rate = 1;
    TextureParameters moved = base;
    Image texture = decode(base);
    descend(options, {gradient, {}}, moved, texture);
    std::vector<Image> result;
    for (std::size_t i = 0; i < base.levels.size(); ++i) {
        result.push_back(base.levels[i].values);
        for (std::size_t k = 0; k < result[i].values.size(); ++k)
            result[i].values[k] -= moved.levels[i].values.values[k];
    }
    return result;
}

/// Each half of a gradient goes down the levels: a step along both is that along their sum.
TEST(Parameterization, HalvesGoDownTheLevelsOnTheirOwn) {
    const TextureParameters base =
        encode({Parameterization::kPyramid, 4}, make_image(37, 18, 3, 0.5f));
    const SplitGradient halves{random_image(37, 18, 3, -1, 1, 61),
                                random_image(37, 18, 3, -1, 1, 62)};
    OptimizerOptions options;
    options.kind = Optimizer::kGatedAdam;
    TextureParameters moved = base;
    Image texture = decode(base);
    descend(options, halves, moved, texture);
    const auto first = level_gradients(base, halves.first),
               second = level_gradients(base, halves.second);
    for (std::size_t i = 1; i < base.levels.size(); ++i)
        for (std::size_t k = 0; k < first[i].values.size(); ++k) {
            EXPECT_NEAR(moved.levels[i].gradient.first.values[k], first[i].values[k], 1e-5f);
            EXPECT_NEAR(moved.levels[i].gradient.second.values[k], second[i].values[k], 1e-5f);
        }
}

TEST(Parameterization, SaysWhereTheHalvesOfTheGradientAgreed) {
    TextureParameters p = encode({Parameterization::kPyramid, 3}, make_image(16, 8, 1, 0.5f));
    OptimizerOptions options;
    EXPECT_EQ(confidence(p).width, 0);
    options.kind = Optimizer::kGatedAdam;
    // The left half of the texture agrees with itself, texel by texel; in the right one there are
    // two texels that the halves tell apart, though not their sum.
    SplitGradient halves{make_image(16, 8, 1), make_image(16, 8, 1)};
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) halves.first.at(x, y, 0) = halves.second.at(x, y, 0) = 1;
    halves.first.at(12, 0, 0) = 1;
    halves.second.at(13, 0, 0) = 1;
    Image texture = decode(p);
    for (int i = 0; i < 3; ++i) descend(options, halves, p, texture);
    const Image sure = confidence(p);
    EXPECT_EQ(sure.at(2, 4, 0), 1.0f);
    EXPECT_EQ(snr_gate(p.levels[0].optimizer.second[12], p.levels[0].optimizer.noise[12]), 0.0f);
    EXPECT_GT(sure.at(12, 0, 0), 0.5f);  // from a coarser level
    EXPECT_EQ(sure.at(15, 7, 0), 0.0f);
    EXPECT_EQ(p.visits[0], 3u);
    EXPECT_EQ(p.visits[12], 3u);
    EXPECT_EQ(p.visits[13], 3u);
    EXPECT_EQ(p.visits[11], 0u);
}

/// |<J x, g> - <x, J^T g>|, relative: J from decode, J^T from descend.
double transpose_error(const TextureParameters& base, const Image& gradient,
                       const std::vector<Image>& transposed) {
    std::vector<Image> x;
    for (const LevelState& level : base.levels)
        x.push_back(random_image(level.values.width, level.values.height, level.values.channels,
                                 -0.01f, 0.01f, 31 + static_cast<std::uint32_t>(x.size())));
    const double direct = dot(decode_change(base, x), gradient);
    double through = 0;
    for (std::size_t i = 0; i < x.size(); ++i) through += dot(x[i], transposed[i]);
    return std::abs(direct - through) / std::abs(direct);
}

TEST(Parameterization, DescendsAlongTheTransposeOfDecode) {
    std::vector<ParameterizationOptions> kinds(3);
    kinds[1].kind = kinds[2].kind = Parameterization::kPyramid;
    kinds[2].upsampling = Upsampling::kBox;
    for (ParameterizationOptions options : kinds)
        for (const int how : {0, 1, 2, 3})
            for (const auto& [width, height, levels] :
                 {std::tuple{8, 8, 20}, {7, 5, 20}, {130, 101, 4}}) {
                // Steps far from the clamp, so that the map is linear: a coarse texel moves by the
                // gradients of all its fine ones.
                const bool charted = how % 2 == 1, repeats = how / 2 == 1;
                options.pyramid_levels = levels;
                const TextureParameters base =
                    encode(options, make_image(width, height, 3, 0.5f),
                           charted ? random_charts(width, height, 81) : ChartMap{}, repeats);
                const Image gradient = random_image(width, height, 3, -1e-3f, 2e-3f, 41);
                auto transposed = level_gradients(base, gradient);
                EXPECT_LT(transpose_error(base, gradient, transposed), 1e-3);
                for (float& v : transposed.back().values) v *= 1.5f;
                EXPECT_GT(transpose_error(base, gradient, transposed), 1e-3)
                    << "a wrong level must be seen";
            }
}

/// A gradient in halves that is zero but for a few blocks of texels, with its flags.
SplitGradient sparse_gradient(int width, int height, int channels, std::uint32_t seed) {
    test::RandomSource random{seed};
    SplitGradient g;
    clear(g, width, height, channels);
    for (int block = 0; block < 3; ++block) {
        const auto below = [&](int n) {
            return std::min(n - 1, static_cast<int>(random.next() * static_cast<float>(n)));
        };
        const int x0 = below(width), y0 = below(height);
        for (int y = y0; y < std::min(height, y0 + 4); ++y)
            for (int x = x0; x < std::min(width, x0 + 7); ++x)
                for (int c = 0; c < channels; ++c) {
                    g.first.at(x, y, c) = random.next(-1, 1);
                    g.second.at(x, y, c) = random.next(-1, 1);
                    const std::size_t i = g.first.index(x, y);
                    mark_dirty(g.reached, i, i + static_cast<std::size_t>(channels));
                }
    }
    return g;
}

/// Steps along gradients whose zeros are flagged are those along the same without flags, and the
/// texture is that of the parameters at every step.
TEST(Parameterization, LeavesOutWhatIsZeroAndNothingElse) {
    std::vector<ParameterizationOptions> kinds(4);
    kinds[1].kind = kinds[2].kind = Parameterization::kPyramid;
    kinds[2].upsampling = Upsampling::kBox;
    kinds[3].kind = Parameterization::kSmooth;
    OptimizerOptions optimizer;
    optimizer.kind = Optimizer::kGatedAdam;
    optimizer.learning_rate = 0.02f;
    for (const ParameterizationOptions& options : kinds)
        for (const int how : {0, 1, 2, 3})
            for (const auto& [width, height, channels] :
                 {std::tuple{150, 97, 1}, {131, 70, 3}, {7, 5, 3}}) {
                const bool charted = how % 2 == 1, repeats = how / 2 == 1;
                TextureParameters flagged =
                    encode(options, random_image(width, height, channels, 0, 1, 91),
                           charted ? random_charts(width, height, 92) : ChartMap{}, repeats);
                TextureParameters plain = flagged;
                Image texture = decode(flagged), expected = texture;
                for (std::uint32_t i = 0; i < 8; ++i) {
                    SplitGradient g = sparse_gradient(width, height, channels, 100 + i);
                    descend(optimizer, g, flagged, texture);
                    g.reached.clear();
                    descend(optimizer, g, plain, expected);
                    ASSERT_EQ(texture.values, expected.values);
                    ASSERT_EQ(flagged.visits, plain.visits);
                    const Image decoded = decode(flagged);
                    for (std::size_t k = 0; k < decoded.values.size(); ++k)
                        ASSERT_NEAR(texture.values[k], decoded.values[k], 1e-6f);
                }
                if (options.kind == Parameterization::kSmooth) continue;  // it reads them all
                SplitGradient wrong = sparse_gradient(width, height, channels, 120);
                *std::find(wrong.reached.begin(), wrong.reached.end(), 1) = 0;
                descend(optimizer, wrong, flagged, texture);
                wrong.reached.clear();
                descend(optimizer, wrong, plain, expected);
                EXPECT_NE(texture.values, expected.values) << "a lost flag must be seen";
            }
}

/// Neither sign makes a zero other than zero; everything else is, wherever it stands.
TEST(Segments, TellZerosFromAllOtherFloats) {
    std::vector<float> zeros(kDirtyBlock, 0.0f);
    for (std::size_t i = 0; i < zeros.size(); i += 2) zeros[i] = -0.0f;
    EXPECT_FALSE(any_nonzero(zeros.data(), zeros.size()));
    EXPECT_FALSE(any_nonzero(nullptr, 0));
    for (const float other : {1.0f, -1.0f, 1e-45f, -1e-45f, INFINITY, -INFINITY, NAN})
        for (const std::size_t at : {std::size_t{0}, std::size_t{17}, kDirtyBlock - 1}) {
            std::vector<float> floats = zeros;
            floats[at] = other;
            EXPECT_TRUE(any_nonzero(floats.data(), floats.size()));
            EXPECT_EQ(any_nonzero(floats.data(), kDirtyBlock - 1), at < kDirtyBlock - 1);
        }
}

/// What is left of a gradient by clear: nothing, whatever its shape was.
TEST(SplitGradient, IsZeroAfterClear) {
    SplitGradient g = sparse_gradient(60, 50, 1, 130);
    for (const auto& [width, height, channels, split] :
         {std::tuple{60, 50, 1, true}, {50, 60, 1, true}, {9, 8, 3, true}, {9, 8, 3, false}}) {
        clear(g, width, height, channels, split);
        EXPECT_EQ(g.second.width, split ? width : 0);
        for (const float v : sum_of(g).values) EXPECT_EQ(v, 0.0f);
        g = sparse_gradient(width, height, channels, 131);
    }
}

/// The texture of a single coarse texel of 1, by the definition of each upsampling.
TEST(Parameterization, UpsamplesByItsWeights) {
    const int width = 11, height = 7;
    for (const auto kind : {Upsampling::kBilinear, Upsampling::kBox})
        for (const bool repeats : {false, true}) {
            ParameterizationOptions options{Parameterization::kPyramid, 2, 0, kind};
            TextureParameters p = encode(options, make_image(width, height, 1), {}, repeats);
            p.levels[1].values.at(0, 2, 0) = 1;
            const Image texture = decode(p);
            const auto along = [&](int i, int size, int coarse) {
                const int near = i / 2, next = near + (i % 2 == 0 ? -1 : 1), last = (size - 1) / 2;
                const int far =
                    repeats ? (next + last + 1) % (last + 1) : std::min(std::max(next, 0), last);
                if (kind == Upsampling::kBox) return near == coarse ? 1.0f : 0.0f;
                return (near == coarse ? 0.75f : 0.0f) + (far == coarse ? 0.25f : 0.0f);
            };
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x)
                    EXPECT_FLOAT_EQ(texture.at(x, y, 0), along(x, width, 0) * along(y, height, 2));
        }
}

/// Evidence at one border of a texture that repeats moves the other border, and only then.
TEST(Parameterization, PyramidGoesRoundWhereATextureRepeats) {
    for (const bool repeats : {false, true}) {
        OptimizerOptions options;
        options.learning_rate = 0.05f;
        TextureParameters p =
            encode({Parameterization::kPyramid, 3}, make_image(32, 32, 1, 0.5f), {}, repeats);
        Image texture = decode(p), gradient = make_image(32, 32, 1);
        for (int y = 0; y < 32; ++y) gradient.at(0, y, 0) = 1;
        for (int i = 0; i < 3; ++i) descend(options, {gradient, {}}, p, texture);
        EXPECT_EQ(texture.at(31, 9, 0) < 0.5f, repeats);
        EXPECT_EQ(texture.at(16, 9, 0), 0.5f);
    }
}

/// A constant coarse level is constant on every texel that reads any of it, and each chart reads
/// its own texels alone.
TEST(Parameterization, PyramidReadsWithinChartsAlone) {
    const int width = 60, height = 41;
    const ChartMap charts = random_charts(width, height, 82);
    const TextureParameters base =
        encode({Parameterization::kPyramid, 2}, make_image(width, height, 1), charts);
    std::vector<std::uint32_t> reached(charts.size(), 0);
    for (std::size_t k = 0; k < base.levels[1].values.values.size(); ++k) {
        TextureParameters p = base;
        p.levels[1].values.values[k] = 0.5f;
        const Image texture = decode(p);
        std::uint32_t seen = 0;
        for (std::size_t i = 0; i < charts.size(); ++i) {
            if (texture.values[i] == 0 || charts[i] == 0) continue;
            if (seen == 0) seen = charts[i];
            EXPECT_EQ(charts[i], seen);
            reached[i] = 1;
        }
    }
    TextureParameters all = base;
    std::fill(all.levels[1].values.values.begin(), all.levels[1].values.values.end(), 0.5f);
    const Image texture = decode(all);
    std::size_t alone = 0;
    for (std::size_t i = 0; i < charts.size(); ++i) {
        if (charts[i] == 0) continue;
        EXPECT_NEAR(texture.values[i], reached[i] ? 0.5f : 0.0f, 1e-6f);
        alone += !reached[i];
    }
    EXPECT_GT(alone, 0u) << "a test of islands that are too small to be heard";
    EXPECT_LT(alone, charts.size() / 10);
}

TEST(Parameterization, PyramidSharesNothingBetweenCharts) {
    const int width = 37, height = 18;
    OptimizerOptions options;
    options.learning_rate = 0.05f;
    TextureParameters p = encode({Parameterization::kPyramid, 5},
                                 make_image(width, height, 1, 0.5f), two_charts(width, height));
    Image texture = decode(p), gradient = make_image(width, height, 1);
    for (int y = 0; y < height; ++y) gradient.at(width / 2 - 1, y, 0) = 1;
    for (int i = 0; i < 5; ++i) descend(options, {gradient, {}}, p, texture);
    EXPECT_LT(texture.at(width / 2 - 3, 4, 0), 0.45f);
    for (int x = width / 2 + 1; x < width; ++x)
        for (int y = 0; y < height; ++y) EXPECT_EQ(texture.at(x, y, 0), 0.5f) << x << ", " << y;
}

/// A step of SGD moves the texture by -B B^T g: <B B^T g, h> = <B^T g, B^T h> is symmetric and
/// positive, and what is constant on a chart stays.
TEST(Parameterization, SmoothStepsAlongASymmetricMapThatKeepsConstants) {
    const int width = 37, height = 18;
    OptimizerOptions options;
    options.kind = Optimizer::kSgd;
    options.learning_rate = 1;
    const auto moved = [&](const Image& gradient) {
        TextureParameters p = encode({Parameterization::kSmooth, 1, 5.0f},
                                     make_image(width, height, 3, 0.5f), two_charts(width, height));
        Image texture = decode(p);
        descend(options, {gradient, {}}, p, texture);
        EXPECT_EQ(decode(p).values, texture.values);
        for (float& v : texture.values) v = 0.5f - v;
        return texture;
    };
    const Image g = random_image(width, height, 3, -0.1f, 0.4f, 71),
                h = random_image(width, height, 3, -0.1f, 0.4f, 72);
    const Image mg = moved(g), mh = moved(h);
    EXPECT_NEAR(dot(mg, h), dot(g, mh), 1e-3 * std::abs(dot(g, mh)));
    const Image noise = random_image(width, height, 3, -0.3f, 0.3f, 73);
    EXPECT_GT(dot(moved(noise), noise), 0);
    EXPECT_LT(dot(moved(noise), noise), 0.2 * dot(noise, noise)) << "noise is averaged away";
    for (const float v : moved(make_image(width, height, 3, 0.25f)).values)
        EXPECT_NEAR(v, 0.25f, 1e-5f);
}

TEST(Parameterization, SmoothSharesNothingBetweenCharts) {
    const int width = 37, height = 18;
    OptimizerOptions options;
    options.learning_rate = 0.05f;
    TextureParameters p = encode({Parameterization::kSmooth, 1, 5.0f},
                                 make_image(width, height, 1, 0.5f), two_charts(width, height));
    Image texture = decode(p), gradient = make_image(width, height, 1);
    gradient.at(width / 2 - 1, 4, 0) = 1;
    for (int i = 0; i < 5; ++i) descend(options, {gradient, {}}, p, texture);
    EXPECT_LT(texture.at(width / 2 - 1, 4, 0), 0.4f);
    EXPECT_LT(texture.at(width / 2 - 1, 15, 0), 0.45f) << "one step for all who hear of it";
    for (int x = width / 2; x < width; ++x)
        for (int y = 0; y < height; ++y) EXPECT_EQ(texture.at(x, y, 0), 0.5f) << x << ", " << y;
}

TEST(Parameterization, SmoothSpreadsEvidenceLessFarAsItGathers) {
    OptimizerOptions options;
    options.kind = Optimizer::kSgd;
    options.learning_rate = 0.1f;
    const auto change_far_away = [&](std::uint32_t steps) {
        TextureParameters p =
            encode({Parameterization::kSmooth, 1, 8.0f}, make_image(65, 1, 1, 0.5f));
        p.levels[0].optimizer.steps = steps;
        Image texture = decode(p), gradient = make_image(65, 1, 1);
        gradient.at(32, 0, 0) = 1;
        descend(options, {gradient, {}}, p, texture);
        return double{0.5f - texture.at(40, 0, 0)} / double{0.5f - texture.at(32, 0, 0)};
    };
    EXPECT_NEAR(change_far_away(0), change_far_away(3), 1e-3);
    EXPECT_GT(change_far_away(0), 0.5);
    EXPECT_LT(change_far_away(40), 0.1);
    EXPECT_EQ(change_far_away(100), change_far_away(400)) << "not below a texel";
}

/// Root mean square of what the levels but the coarsest differ by from where they started.
double detail(const TextureParameters& p, const TextureParameters& start) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i + 1 < p.levels.size(); ++i)
        for (std::size_t k = 0; k < p.levels[i].values.values.size(); ++k) {
            sum += std::pow(
                double{p.levels[i].values.values[k]} - double{start.levels[i].values.values[k]}, 2);
            ++count;
        }
    return std::sqrt(sum / count);
}

/// What a few gradients wrote into the fine levels goes away when nothing asks for it again, and
/// what the start held does not; the coarsest level keeps what it has.
TEST(Parameterization, PyramidForgetsDetailThatIsNotAskedForAgain) {
    for (const bool constant : {true, false})
        for (const bool charted : {false, true})
            for (const float decay : {0.0f, 10.0f}) {
                ParameterizationOptions options{Parameterization::kPyramid, 3};
                options.weight_decay = decay;
                const int width = 61, height = 37;
                const Image initial = constant ? make_image(width, height, 3, 0.4f)
                                               : random_image(width, height, 3, 0.3f, 0.6f, 141);
                const TextureParameters start = encode(
                    options, initial, charted ? random_charts(width, height, 142) : ChartMap{});
                TextureParameters p = start;
                OptimizerOptions optimizer;
                optimizer.learning_rate = 0.003f;
                Image texture = decode(p);
                const auto descend_along = [&](const Image& g) {
                    descend(optimizer, {g, {}, {}}, p, texture);
                };
                for (std::uint32_t i = 0; i < 10; ++i)
                    descend_along(random_image(width, height, 3, -1, 1, 143 + i));
                EXPECT_GT(detail(p, start), 2e-3);
                const Image coarsest = p.levels.back().values;
                for (int i = 0; i < 400; ++i) descend_along(make_image(width, height, 3));
                if (decay > 0)
                    EXPECT_LT(detail(p, start), 1e-4);
                else
                    EXPECT_GT(detail(p, start), 2e-3);
                EXPECT_GT(dot(p.levels.back().values, p.levels.back().values),
                          0.5 * dot(coarsest, coarsest));
            }
}

TEST(Parameterization, DetailStaysWhereThereIsNoCoarserLevel) {
    for (const Parameterization kind :
         {Parameterization::kTexels, Parameterization::kPyramid, Parameterization::kSmooth}) {
        ParameterizationOptions options{kind, 1};
        options.smoothing_length = 0;
        options.weight_decay = 10;
        TextureParameters p = encode(options, make_image(8, 8, 1, 0.5f));
        Image texture = decode(p);
        descend({}, {random_image(8, 8, 1, -1, 1, 151), {}, {}}, p, texture);
        const Image moved = texture;
        TextureParameters without = p;
        without.weight_decay = 0;
        Image expected = texture;
        descend({}, {make_image(8, 8, 1), {}, {}}, p, texture);
        descend({}, {make_image(8, 8, 1), {}, {}}, without, expected);
        EXPECT_EQ(texture.values, expected.values);
        EXPECT_NE(texture.values, moved.values);
    }
}

/// Of noise with a mean that only sums over many texels show, the fine levels agree on little: they
/// make shorter steps, the coarsest makes the same.
TEST(Parameterization, PyramidHardlyMovesLevelsThatAreTooFineForThePicture) {
    OptimizerOptions optimizer;
    optimizer.kind = Optimizer::kGatedAdam;
    optimizer.learning_rate = 0.001f;  // nothing reaches the end of its range
    const int side = 64, levels = 4;
    std::array<TextureParameters, 2> runs;
    for (const bool weighs : {false, true}) {
        ParameterizationOptions options{Parameterization::kPyramid, levels};
        options.weight_decay = 0;
        options.snr_prior = weighs ? 0.25f : 0.0f;
        TextureParameters& p = runs[weighs];
        p = encode(options, make_image(side, side, 1, 0.5f));
        Image texture = decode(p);
        for (std::uint32_t i = 0; i < 30; ++i)
            descend(optimizer,
                    {random_image(side, side, 1, -0.9f, 1.1f, 161 + 2 * i),
                     random_image(side, side, 1, -0.9f, 1.1f, 162 + 2 * i),
                     {}},
                    p, texture);
    }
    const auto distance = [](const TextureParameters& p) {  // of the finest level
        const std::vector<float>& values = p.levels.front().values.values;
        double sum = 0;
        for (const float v : values) sum += std::pow(double{v} - 0.5, 2);
        return std::sqrt(sum / static_cast<double>(values.size()));
    };
    EXPECT_EQ(runs[0].levels.back().values.values, runs[1].levels.back().values.values);
    EXPECT_EQ(runs[0].levels.front().optimizer.mean_gate, 1);
    EXPECT_LT(distance(runs[1]), 0.9 * distance(runs[0]));
    EXPECT_GT(distance(runs[0]), 1e-3);
    EXPECT_LT(runs[1].levels[0].optimizer.mean_gate,
              runs[1].levels[1].optimizer.mean_gate);
}

TEST(Parameterization, StaysInRangeAndDoesNotRunAwayBehindTheClamp) {
    OptimizerOptions options;
    options.learning_rate = 0.2f;
    TextureParameters p = encode({Parameterization::kPyramid, 20}, make_image(4, 4, 1, 0.9f));
    Image texture = decode(p);
    for (int i = 0; i < 20; ++i) descend(options, {make_image(4, 4, 1, -1.0f), {}}, p, texture);
    for (const float v : texture.values) EXPECT_NEAR(v, 1.0f, 1e-6f);
    EXPECT_EQ(decode(p).values, texture.values);
    // One step back the other way moves at once. Adam's mean has to turn first: use SGD.
    options.kind = Optimizer::kSgd;
    options.learning_rate = 0.01f;
    for (LevelState& level : p.levels) level.optimizer = {};
    descend(options, {make_image(4, 4, 1, 1.0f), {}}, p, texture);
    for (const float v : texture.values) EXPECT_LT(v, 1.0f);
}

}  // namespace
}  // namespace burnish
