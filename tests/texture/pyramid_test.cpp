// Pyramids: what is encoded comes back, and the gradient goes through the transposed map. One level
// is the texture itself.
#include "texture/pyramid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
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

/// A pyramid with all that a step of it reads and writes.
struct PyramidRun {
    AdamOptions adam;
    PyramidMaps maps;
    PyramidState state;
    PyramidWorkspace workspace = {};
};

/// The decay and the prior of Options::pyramid.
AdamOptions default_adam() {
    AdamOptions adam;
    adam.weight_decay = 0.5f, adam.snr_prior = 0.25f;
    return adam;
}

PyramidRun make_run(int levels, const Image& initial, const ChartMap& charts = {},
                    bool repeats = false, const AdamOptions& adam = default_adam()) {
    PyramidRun run{adam, make_maps(levels, initial.width, initial.height, charts, repeats), {}};
    run.state = encode(run.maps, initial, adam.weight_decay > 0);
    return run;
}

Image decode(const PyramidRun& run) { return decode(run.maps, run.state); }

void descend(const SplitGradient& gradient, PyramidRun& run, Image& texture) {
    descend(run.adam, run.maps, gradient, run.state, run.workspace, texture);
}

double dot(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i)
        sum += double{a.values[i]} * double{b.values[i]};
    return sum;
}

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

/// Adds x to the levels, and returns the texture's change: decode is linear inside its range.
Image decode_change(const PyramidRun& base, const std::vector<Image>& x) {
    PyramidRun moved = base;
    for (std::size_t i = 0; i < x.size(); ++i)
        for (std::size_t k = 0; k < x[i].values.size(); ++k)
            moved.state.levels[i].values.values[k] += x[i].values[k];
    Image change = decode(moved);
    const Image before = decode(base);
    for (std::size_t k = 0; k < change.values.size(); ++k) change.values[k] -= before.values[k];
    return change;
}

/// The gradient by the levels that descend() steps along: Adam's mean after one step, without
/// decay.
std::vector<Image> level_gradients(PyramidRun run, const Image& gradient) {
    run.adam.beta1 = 0;
    Image texture = decode(run);
    descend({gradient, {}}, run, texture);
    std::vector<Image> result;
    for (const LevelState& level : run.state.levels) {
        result.push_back(level.values);
        result.back().values = level.adam.mean;
    }
    return result;
}

/// Each half of a gradient goes down the levels: a step along both is that along their sum.
TEST(Pyramid, HalvesGoDownTheLevelsOnTheirOwn) {
    const PyramidRun base = make_run(4, make_image(37, 18, 3, 0.5f));
    const SplitGradient halves{random_image(37, 18, 3, -1, 1, 61),
                               random_image(37, 18, 3, -1, 1, 62)};
    PyramidRun moved = base;
    moved.adam.gate = true;
    Image texture = decode(base);
    descend(halves, moved, texture);
    const auto first = level_gradients(base, halves.first),
               second = level_gradients(base, halves.second);
    for (std::size_t i = 1; i < base.state.levels.size(); ++i)
        for (std::size_t k = 0; k < first[i].values.size(); ++k) {
            EXPECT_NEAR(moved.workspace.levels[i].gradient.first.values[k], first[i].values[k],
                        1e-5f);
            EXPECT_NEAR(moved.workspace.levels[i].gradient.second.values[k], second[i].values[k],
                        1e-5f);
        }
}

TEST(Pyramid, ConfidenceIsWhereTheHalvesOfTheGradientAreEqual) {
    PyramidRun run = make_run(3, make_image(16, 8, 1, 0.5f));
    EXPECT_EQ(confidence(run.state).width, 0);
    run.adam.gate = true;
    // In the left half of the texture the halves of the gradient are equal; in the right one there
    // are two texels that they tell apart, though not their sum.
    SplitGradient halves{make_image(16, 8, 1), make_image(16, 8, 1)};
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) halves.first.at(x, y, 0) = halves.second.at(x, y, 0) = 1;
    halves.first.at(12, 0, 0) = 1;
    halves.second.at(13, 0, 0) = 1;
    Image texture = decode(run);
    for (int i = 0; i < 3; ++i) descend(halves, run, texture);
    const Image sure = confidence(run.state);
    EXPECT_EQ(sure.at(2, 4, 0), 1.0f);
    EXPECT_EQ(snr_gate(run.state.levels[0].adam.square[12], run.state.levels[0].adam.noise[12]),
              0.0f);
    EXPECT_GT(sure.at(12, 0, 0), 0.5f);  // from a coarser level
    EXPECT_EQ(sure.at(15, 7, 0), 0.0f);
    EXPECT_EQ(run.state.visits[0], 3u);
    EXPECT_EQ(run.state.visits[12], 3u);
    EXPECT_EQ(run.state.visits[13], 3u);
    EXPECT_EQ(run.state.visits[11], 0u);
}

/// |<J x, g> - <x, J^T g>|, relative: J from decode, J^T from descend.
double transpose_error(const PyramidRun& base, const Image& gradient,
                       const std::vector<Image>& transposed) {
    std::vector<Image> x;
    for (const LevelState& level : base.state.levels)
        x.push_back(random_image(level.values.width, level.values.height, level.values.channels,
                                 -0.01f, 0.01f, 31 + static_cast<std::uint32_t>(x.size())));
    const double direct = dot(decode_change(base, x), gradient);
    double through = 0;
    for (std::size_t i = 0; i < x.size(); ++i) through += dot(x[i], transposed[i]);
    return std::abs(direct - through) / std::abs(direct);
}

TEST(Pyramid, DescendsAlongTheTransposeOfDecode) {
    for (const bool pyramid : {false, true})
        for (const int how : {0, 1, 2, 3})
            for (const auto& [width, height, levels] :
                 {std::tuple{8, 8, 20}, {7, 5, 20}, {130, 101, 4}}) {
                // Steps far from the clamp, so that the map is linear: a coarse texel moves by the
                // gradients of all its fine ones.
                const bool charted = how % 2 == 1, repeats = how / 2 == 1;
                const PyramidRun base =
                    make_run(pyramid ? levels : 1, make_image(width, height, 3, 0.5f),
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
                    mark_dirty(g.dirty, i, i + static_cast<std::size_t>(channels));
                }
    }
    return g;
}

/// Steps along gradients whose zeros are flagged are those along the same without flags, and the
/// texture is that of the parameters at every step.
TEST(Pyramid, LeavesOutWhatIsZeroAndNothingElse) {
    AdamOptions adam = default_adam();
    adam.gate = true;
    adam.learning_rate = 0.02f;
    for (const int levels : {1, 5})
        for (const int how : {0, 1, 2, 3})
            for (const auto& [width, height, channels] :
                 {std::tuple{150, 97, 1}, {131, 70, 3}, {7, 5, 3}}) {
                const bool charted = how % 2 == 1, repeats = how / 2 == 1;
                PyramidRun flagged = make_run(
                    levels, random_image(width, height, channels, 0, 1, 91),
                    charted ? random_charts(width, height, 92) : ChartMap{}, repeats, adam);
                PyramidRun plain = flagged;
                Image texture = decode(flagged), expected = texture;
                for (std::uint32_t i = 0; i < 8; ++i) {
                    SplitGradient g = sparse_gradient(width, height, channels, 100 + i);
                    descend(g, flagged, texture);
                    g.dirty.clear();
                    descend(g, plain, expected);
                    ASSERT_EQ(texture.values, expected.values);
                    ASSERT_EQ(flagged.state.visits, plain.state.visits);
                    const Image decoded = decode(flagged);
                    for (std::size_t k = 0; k < decoded.values.size(); ++k)
                        ASSERT_NEAR(texture.values[k], decoded.values[k], 1e-6f);
                }
                SplitGradient wrong = sparse_gradient(width, height, channels, 120);
                *std::find(wrong.dirty.begin(), wrong.dirty.end(), 1) = 0;
                descend(wrong, flagged, texture);
                wrong.dirty.clear();
                descend(wrong, plain, expected);
                EXPECT_NE(texture.values, expected.values) << "a lost flag must be seen";
            }
}

/// Neither sign makes a zero other than zero; everything else is, wherever it stands.
TEST(DirtyBlocks, TellZerosFromAllOtherFloats) {
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

/// The texture of a single coarse texel of 1, by the definition of bilinear prolongation.
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

/// Root mean square of what the levels but the coarsest differ by from where they started.
double detail(const PyramidState& p, const PyramidState& start) {
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
TEST(Pyramid, ForgetsDetailThatIsNotAskedForAgain) {
    for (const bool constant : {true, false})
        for (const bool charted : {false, true})
            for (const float decay : {0.0f, 10.0f}) {
                const int width = 61, height = 37;
                const Image initial = constant ? make_image(width, height, 3, 0.4f)
                                               : random_image(width, height, 3, 0.3f, 0.6f, 141);
                AdamOptions adam = default_adam();
                adam.weight_decay = decay;
                adam.learning_rate = 0.003f;
                PyramidRun run =
                    make_run(3, initial, charted ? random_charts(width, height, 142) : ChartMap{},
                             false, adam);
                const PyramidState start = run.state;
                Image texture = decode(run);
                const auto descend_along = [&](const Image& g) {
                    descend({g, {}, {}}, run, texture);
                };
                for (std::uint32_t i = 0; i < 10; ++i)
                    descend_along(random_image(width, height, 3, -1, 1, 143 + i));
                EXPECT_GT(detail(run.state, start), 2e-3);
                const Image coarsest = run.state.levels.back().values;
                for (int i = 0; i < 400; ++i) descend_along(make_image(width, height, 3));
                if (decay > 0)
                    EXPECT_LT(detail(run.state, start), 1e-4);
                else
                    EXPECT_GT(detail(run.state, start), 2e-3);
                EXPECT_GT(dot(run.state.levels.back().values, run.state.levels.back().values),
                          0.5 * dot(coarsest, coarsest));
            }
}

TEST(Pyramid, DetailStaysWhereThereIsNoCoarserLevel) {
    AdamOptions adam = default_adam();
    adam.weight_decay = 10;
    PyramidRun run = make_run(1, make_image(8, 8, 1, 0.5f), {}, false, adam);
    Image texture = decode(run);
    descend({random_image(8, 8, 1, -1, 1, 151), {}, {}}, run, texture);
    const Image moved = texture;
    PyramidRun without = run;
    without.adam.weight_decay = 0;
    Image expected = texture;
    descend({make_image(8, 8, 1), {}, {}}, run, texture);
    descend({make_image(8, 8, 1), {}, {}}, without, expected);
    EXPECT_EQ(texture.values, expected.values);
    EXPECT_NE(texture.values, moved.values);
}

/// Of noise with a mean that only sums over many texels show, the fine levels have little signal:
/// they make shorter steps, the coarsest makes the same.
TEST(Pyramid, HardlyMovesLevelsThatAreTooFineForThePicture) {
    const int side = 64, levels = 4;
    std::array<PyramidState, 2> states;
    for (const bool prior : {false, true}) {
        AdamOptions adam;
        adam.gate = true;
        adam.learning_rate = 0.001f;  // nothing reaches the end of its range
        adam.snr_prior = prior ? 0.25f : 0.0f;
        PyramidRun run = make_run(levels, make_image(side, side, 1, 0.5f), {}, false, adam);
        Image texture = decode(run);
        for (std::uint32_t i = 0; i < 30; ++i)
            descend({random_image(side, side, 1, -0.9f, 1.1f, 161 + 2 * i),
                     random_image(side, side, 1, -0.9f, 1.1f, 162 + 2 * i),
                     {}},
                    run, texture);
        states[prior] = run.state;
    }
    const auto distance = [](const PyramidState& p) {  // of the finest level
        const std::vector<float>& values = p.levels.front().values.values;
        double sum = 0;
        for (const float v : values) sum += std::pow(double{v} - 0.5, 2);
        return std::sqrt(sum / static_cast<double>(values.size()));
    };
    EXPECT_EQ(states[0].levels.back().values.values, states[1].levels.back().values.values);
    EXPECT_EQ(states[0].levels.front().adam.mean_gate, 1);
    EXPECT_LT(distance(states[1]), 0.9 * distance(states[0]));
    EXPECT_GT(distance(states[0]), 1e-3);
    EXPECT_LT(states[1].levels[0].adam.mean_gate, states[1].levels[1].adam.mean_gate);
}

TEST(Pyramid, StaysInRangeAndDoesNotRunAwayBehindTheClamp) {
    PyramidRun run = make_run(20, make_image(4, 4, 1, 0.9f));
    run.adam.learning_rate = 0.2f;
    Image texture = decode(run);
    for (int i = 0; i < 20; ++i) descend({make_image(4, 4, 1, -1.0f), {}}, run, texture);
    for (const float v : texture.values) EXPECT_NEAR(v, 1.0f, 1e-6f);
    EXPECT_EQ(decode(run).values, texture.values);
    // One step back the other way moves at once, where Adam has no mean that has to turn first.
    run.adam.learning_rate = 0.01f;
    run.adam.weight_decay = 0;
    for (LevelState& level : run.state.levels) level.adam = {};
    descend({make_image(4, 4, 1, 1.0f), {}}, run, texture);
    for (const float v : texture.values) EXPECT_LT(v, 1.0f);
}

}  // namespace
}  // namespace burnish
