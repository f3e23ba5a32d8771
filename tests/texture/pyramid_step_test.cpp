// Steps of a pyramid: the gradient goes through the transposed map, level by level, and what it is
// weighed with.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "texture/pyramid_run.h"

namespace burnish {
namespace {

using namespace test;

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
    // Coarse levels have other texels at the other row.
    for (const int row : {0, 7}) {
        PyramidRun run = make_run(3, make_image(16, 8, 1, 0.5f));
        EXPECT_EQ(confidence(run.maps, run.state).width, 0);
        run.adam.gate = true;
        // In the left half of the texture the halves of the gradient are equal; in the right one
        // there are two texels that they tell apart, though not their sum.
        SplitGradient halves{make_image(16, 8, 1), make_image(16, 8, 1)};
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x) halves.first.at(x, y, 0) = halves.second.at(x, y, 0) = 1;
        halves.first.at(12, row, 0) = 1;
        halves.second.at(13, row, 0) = 1;
        Image texture = decode(run);
        for (int i = 0; i < 3; ++i) descend(halves, run, texture);
        const Image sure = confidence(run.maps, run.state);
        EXPECT_EQ(sure.at(2, 4, 0), 1.0f);
        const auto first = static_cast<std::size_t>(row * 16 + 12);
        const AdamState& finest = run.state.levels[0].adam;
        EXPECT_EQ(snr_gate(finest.square[first], finest.noise[first]), 0.0f);
        EXPECT_GT(sure.at(12, row, 0), 0.5f);  // from a coarser level
        EXPECT_EQ(sure.at(12, row == 0 ? 1 : 6, 0), 0.0f)
            << "not visited, whatever the coarser level knows";
        EXPECT_EQ(sure.at(15, row, 0), 0.0f);
        EXPECT_EQ(run.state.visits[0], 3u);
        EXPECT_EQ(run.state.visits[first], 3u);
        EXPECT_EQ(run.state.visits[first + 1], 3u);
        EXPECT_EQ(run.state.visits[first - 1], 0u);
    }
}

/// At the border of a second chart, in column 9, the halves of the gradient have nothing in common,
/// and the coarse texel there is of the first chart.
TEST(Pyramid, ConfidenceIsThatOfTheTexelsOwnChart) {
    const auto sure_at_border = [](int end, bool is_first_equal) {
        ChartMap charts;
        SplitGradient halves{make_image(16, 8, 1, 1), make_image(16, 8, 1)};
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 16; ++x) {
                const bool is_second = x >= 9 && x < end;
                charts.push_back(is_second ? 2u : 1u);
                halves.second.at(x, y, 0) = x != 9 && (is_second || is_first_equal) ? 1.0f : 0.0f;
            }
        PyramidRun run = make_run(3, make_image(16, 8, 1, 0.5f), charts);
        run.adam.gate = true;
        Image texture = decode(run);
        for (int i = 0; i < 3; ++i) descend(halves, run, texture);
        return confidence(run.maps, run.state).at(9, 4, 0);
    };
    EXPECT_EQ(sure_at_border(10, true), 0.0f) << "one column reads nothing coarser";
    EXPECT_GT(sure_at_border(12, false), 0.5f) << "three read a column of their own";
}

/// One texel's gradient moves coarse texels at the end of a block: so do all texels that read them,
/// in whatever block they lie, across the border of a texture that repeats too.
TEST(Pyramid, MovesEveryTexelThatReadsACoarseOneThatMoves) {
    constexpr int kWidth = 4 * kDirtyBlock;
    for (const bool repeats : {false, true})
        for (const int x : {1, 94, 97, kWidth - 2}) {
            PyramidRun run = make_run(2, make_image(kWidth, 2, 1, 0.5f), {}, repeats);
            run.adam.learning_rate = 0.01f;
            Image texture = decode(run), gradient = make_image(kWidth, 2, 1);
            gradient.at(x, 0, 0) = 1;
            for (int i = 0; i < 2; ++i) descend({gradient, {}}, run, texture);
            const Image decoded = decode(run);
            for (std::size_t k = 0; k < texture.values.size(); ++k)
                ASSERT_NEAR(texture.values[k], decoded.values[k], 1e-6f) << x << ": " << k;
        }
}

/// Halves that cancel each other have visited a texel.
TEST(Pyramid, CountsVisitsOfEitherHalf) {
    for (const int channels : {1, 3}) {
        PyramidRun run = make_run(2, make_image(4, 1, channels, 0.5f));
        SplitGradient halves{make_image(4, 1, channels), make_image(4, 1, channels)};
        halves.first.at(1, 0, 0) = 2, halves.second.at(1, 0, 0) = -2;
        halves.second.at(2, 0, channels - 1) = -1;
        halves.first.at(3, 0, 0) = 1, halves.first.at(3, 0, channels - 1) -= 1;
        Image texture = decode(run);
        descend(halves, run, texture);
        EXPECT_EQ(run.state.visits, (std::vector<std::uint32_t>{0, 1, 1, channels == 3 ? 1u : 0u}));
    }
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

/// Texels on the left move the pictures a hundred times less than those on the right: damped, each
/// level leaves them where they are, but as far as coarser texels reach over the border.
TEST(Pyramid, HardlyMovesTexelsThatMoveThePicturesLittle) {
    const int side = 64;
    for (const bool damped : {false, true}) {
        AdamOptions adam;
        adam.gate = true;
        adam.learning_rate = 0.001f;  // nothing reaches the end of its range
        adam.damping = damped ? 1.0f : 0.0f;
        PyramidRun run = make_run(4, make_image(side, side, 1, 0.5f), {}, false, adam);
        Image texture = decode(run);
        for (std::uint32_t i = 0; i < 30; ++i) {
            Image first = random_image(side, side, 1, -0.9f, 1.1f, 161 + 2 * i);
            Image second = random_image(side, side, 1, -0.9f, 1.1f, 162 + 2 * i);
            for (Image* half : {&first, &second})
                for (int y = 0; y < side; ++y)
                    for (int x = 0; x < side / 2; ++x) half->values[half->index(x, y)] *= 0.01f;
            descend({first, second, {}}, run, texture);
        }
        const auto distance = [&](int begin, int end) {
            double sum = 0;
            for (int y = 0; y < side; ++y)
                for (int x = begin; x < end; ++x)
                    sum += std::pow(double{texture.values[texture.index(x, y)]} - 0.5, 2);
            return std::sqrt(sum / (side * (end - begin)));
        };
        const double ratio = distance(0, side / 4) / distance(3 * side / 4, side);
        if (damped)
            EXPECT_LT(ratio, 0.1);
        else
            EXPECT_GT(ratio, 0.8);
        EXPECT_GT(distance(3 * side / 4, side), 1e-3);
    }
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

/// Only texels that are given other values move, exactly there; their gradients are forgotten, and
/// weight decay asks for the new ones.
TEST(Pyramid, StartsAnewWhereItIsTold) {
    for (const int levels : {1, 4}) {
        PyramidRun run = make_run(levels, make_image(37, 18, 3, 0.5f));
        run.adam.gate = true;
        Image texture = decode(run);
        for (std::uint32_t i = 0; i < 3; ++i)
            descend(
                {random_image(37, 18, 3, -1, 1, 70 + i), random_image(37, 18, 3, -1, 1, 80 + i)},
                run, texture);
        const PyramidState before = run.state;
        const Image moved = texture, from = make_image(37, 18, 3, 0.5f);
        Image to = from;
        for (const int x : {4, 30})
            for (int c = 0; c < 3; ++c) to.at(x, 7, c) = 0.1f * static_cast<float>(c + 1);
        EXPECT_EQ(restart(run.maps, from, from, run.state, texture), 0u);
        EXPECT_TRUE(run.state == before && texture == moved);
        EXPECT_EQ(restart(run.maps, from, to, run.state, texture), 2u);
        const AdamState& adam = run.state.levels[0].adam;
        const Image decoded = decode(run);
        for (std::size_t k = 0; k < texture.values.size(); ++k) {
            const bool is_new = from.values[k] != to.values[k];
            EXPECT_EQ(texture.values[k], (is_new ? to : moved).values[k]);
            EXPECT_NEAR(decoded.values[k], texture.values[k], 1e-6f);
            EXPECT_EQ(adam.mean[k], is_new ? 0 : before.levels[0].adam.mean[k]);
            EXPECT_EQ(adam.square[k], is_new ? 0 : before.levels[0].adam.square[k]);
            EXPECT_EQ(adam.noise[k], is_new ? 0 : before.levels[0].adam.noise[k]);
            if (levels > 1 && !is_new) {
                EXPECT_EQ(adam.initial[k], 0.5f);
            }
        }
    }
}

/// After 3000 steps without a gradient weight decay has drawn levels to where they started.
TEST(Pyramid, StaysWhereItStartsAnew) {
    constexpr float kTo = 0.7f;
    PyramidRun run = make_run(4, make_image(37, 18, 1, 0.3f));
    Image texture = decode(run);
    const Image up = make_image(37, 18, 1, -1.0f), none = make_image(37, 18, 1, 0.0f);
    for (int i = 0; i < 8; ++i) descend({up, up, {}}, run, texture);
    for (int i = 0; i < 60; ++i) descend({none, none, {}}, run, texture);
    EXPECT_GT(run.state.levels.back().values.at(3, 1, 0), 0.05f) << "no decay there";
    Image from = make_image(37, 18, 1, 0.3f), to = from;
    to.at(20, 9, 0) = kTo;
    restart(run.maps, from, to, run.state, texture);
    EXPECT_EQ(texture.at(20, 9, 0), kTo);
    const float beside = texture.at(21, 9, 0);
    for (int i = 0; i < 3000; ++i) descend({none, none, {}}, run, texture);
    EXPECT_LT(texture.at(21, 9, 0), beside - 0.05f) << "finer levels go back";
    EXPECT_NEAR(texture.at(20, 9, 0), kTo, 0.005f);
}

}  // namespace
}  // namespace burnish
