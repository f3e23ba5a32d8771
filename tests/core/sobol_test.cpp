// Sobol's sequence against its published points; scrambling: exact where it is a permutation, by
// counting points where it keeps them evenly spread, by a chi-square test where numbers must be
// independent.
#include "core/sobol.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "ledger_entries.h"
#include "statistics.h"

namespace burnish {
namespace {

using test::accepted;
using test::rejected;
using test::scaled;
using test::seed_of;
using test::ledger::kSobol;

using Counter = std::array<std::uint32_t, 4>;
using Point = std::array<std::uint32_t, kSobolDimensions>;

/// All dimensions of point n in [0, 2^32), scrambled where there are seeds.
Point point(std::uint32_t n, const Point* seeds = nullptr) {
    auto x = sobol_reversed<0, kSobolDimensions>(n);
    for (std::size_t d = 0; d < kSobolDimensions; ++d)
        x[d] = reverse_bits(seeds ? scramble_reversed(x[d], (*seeds)[d]) : x[d]);
    return x;
}

TEST(Sobol, PointsAreThePublishedOnes) {
    struct Published {
        std::uint32_t index;  ///< in the order of the Gray code
        double at[kSobolDimensions];
    };
    constexpr Published kPoints[] = {
        {0, {0, 0, 0, 0, 0, 0, 0}},
        {1, {.5, .5, .5, .5, .5, .5, .5}},
        {2, {.75, .25, .25, .25, .75, .75, .25}},
        {3, {.25, .75, .75, .75, .25, .25, .75}},
        {4, {.375, .375, .625, .875, .375, .125, .375}},
        {5, {.875, .875, .125, .375, .875, .625, .875}},
        {6, {.625, .125, .875, .625, .625, .875, .125}},
        {7, {.125, .625, .375, .125, .125, .375, .625}},
        {25, {.65625, .65625, .03125, .34375, .34375, .15625, .46875}},
        {100, {.4140625, .2578125, .7734375, .7265625, .8828125, .7421875, .0234375}},
        {1000,
         {.2197265625, .0966796875, .5185546875, .6767578125, .2802734375, .9072265625,
          .0458984375}}};
    for (const auto& [index, at] : kPoints) {
        const Point x = point(index ^ (index >> 1));
        for (std::size_t d = 0; d < kSobolDimensions; ++d)
            EXPECT_EQ(x[d] * 0x1p-32, at[d]) << index << " " << d;
    }
}

TEST(Sobol, PacketsAgreeWithFloats) {
    const RandomKey key{42, Stream::kCacheA};
    for (std::uint32_t first = 0; first < 4000; first += 41) {
        LaneIntegers sample, number;
        for (int k = 0; k < kLanes; ++k) {
            const auto i = static_cast<std::uint32_t>(k);
            set(sample, k, first * 2654435761u + i), set(number, k, (first + 3 * i) << (i % 21));
        }
        const std::uint32_t block = first % 4;
        const auto packed = sobol_uniforms(key, sample, number, block);
        const auto fifth = sobol_fifth(key, sample, number, block);
        for (int k = 0; k < kLanes; ++k) {
            const std::uint32_t s = get(sample, k), n = get(number, k);
            const auto one = sobol_uniforms(key, s, n, block);
            for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(get(packed[c], k), one[c]);
            EXPECT_EQ(get(fifth, k), sobol_fifth(key, s, n, block));
        }
    }
}

/// The bits of a number that weigh most come first in reversed bits and depend on nothing behind
/// them, so these tests of the first sixteen are exhaustive.
constexpr std::uint32_t kFirst = 0xffff;

TEST(Sobol, ANumberIsExactlyUniformOverTheSeeds) {
    for (const std::uint32_t x : {0u, 1u, 0x8000u, 0x1234u, 0xffffu}) {
        std::vector<bool> reached(kFirst + 1, false);
        for (std::uint32_t seed = 0; seed <= kFirst; ++seed)
            reached[scramble_reversed(x, seed) & kFirst] = true;
        EXPECT_EQ(std::count(reached.begin(), reached.end(), true), kFirst + 1);
    }
}

TEST(Sobol, ScramblingExchangesIntervalsWithTheirSiblings) {
    for (const std::uint32_t seed : {0u, 1u, 0x9e3779b9u, ~0u}) {
        std::vector<bool> reached(kFirst + 1, false);
        for (std::uint32_t x = 0; x <= kFirst; ++x) {
            const std::uint32_t y = scramble_reversed(x, seed);
            reached[y & kFirst] = true;
            for (std::uint32_t bit = 1; bit < 32; ++bit) {  // changes none before it
                const std::uint32_t before = (1u << bit) - 1;
                EXPECT_EQ(scramble_reversed(x ^ (1u << bit), seed) & before, y & before);
            }
        }
        EXPECT_EQ(std::count(reached.begin(), reached.end(), true), kFirst + 1);
    }
}

std::uint32_t leading(std::uint32_t x, std::uint32_t bits) {
    return bits == 0 ? 0 : x >> (32 - bits);
}

/// Whether 2^m points in dimensions a and b form a (t, m, 2)-net: 2^t in each interval of size
/// 2^(t - m), whatever its shape.
bool is_net(const std::vector<Point>& points, std::size_t a, std::size_t b, std::uint32_t m,
            std::uint32_t t) {
    for (std::uint32_t bits = 0; bits <= m - t; ++bits) {
        std::vector<std::uint32_t> count(std::size_t{1} << (m - t), 0);
        for (const Point& x : points)
            ++count[(leading(x[a], bits) << (m - t - bits)) | leading(x[b], m - t - bits)];
        for (const std::uint32_t c : count)
            if (c != 1u << t) return false;
    }
    return true;
}

/// The least t.
std::uint32_t quality(const std::vector<Point>& points, std::size_t a, std::size_t b,
                      std::uint32_t m) {
    std::uint32_t t = 0;
    while (!is_net(points, a, b, m, t)) ++t;
    return t;
}

/// 2^m contiguous points that begin at block 2^m.
std::vector<Point> points_of(std::uint32_t block, std::uint32_t m, const Point* seeds = nullptr) {
    std::vector<Point> points(std::size_t{1} << m);
    for (std::uint32_t n = 0; n < points.size(); ++n) points[n] = point((block << m) + n, seeds);
    return points;
}

TEST(Sobol, ScrambledPointsStayNets) {
    for (std::uint32_t m = 1; m <= 7; ++m)
        for (const std::uint32_t block : {0u, 1u, 5u})  // any aligned run is as good as the first
            for (std::uint32_t seed = 0; seed < 8; ++seed) {
                const auto s = philox4x32(Counter{seed, block, 0, 0}, {m, 0}),
                           more = philox4x32(Counter{seed, block, 1, 0}, {m, 0});
                const Point seeds{s[0], s[1], s[2], s[3], more[0], more[1], more[2]};
                const auto plain = points_of(block, m), scrambled = points_of(block, m, &seeds);
                EXPECT_TRUE(is_net(scrambled, 0, 1, m, 0));
                for (std::size_t a = 0; a < kSobolDimensions; ++a) {
                    std::set<std::uint32_t> intervals;
                    for (const Point& x : scrambled) intervals.insert(leading(x[a], m));
                    EXPECT_EQ(intervals.size(), scrambled.size()) << "dimension " << a;
                    for (std::size_t b = a + 1; b < kSobolDimensions; ++b)
                        EXPECT_EQ(quality(scrambled, a, b, m), quality(plain, a, b, m));
                }
            }
}

TEST(Sobol, AnOrderOfItsOwnKeepsAlignedRuns) {
    const RandomKey key{9, Stream::kCacheA};
    for (std::uint32_t m = 1; m <= 7; ++m)
        for (const std::uint32_t begin : {0u, 1u << m, 5u << m}) {
            std::set<std::uint32_t> points, runs;
            for (std::uint32_t n = begin; n < begin + (1u << m); ++n) {
                const std::uint32_t at = sobol_point(key, 3u, n, kSobolBlocksInOrder + m);
                points.insert(at), runs.insert(at >> m);
                EXPECT_EQ(sobol_point(key, 3u, n, kSobolBlocksInOrder - 1), n);
            }
            EXPECT_EQ(points.size(), 1u << m);
            EXPECT_EQ(runs.size(), 1u);
        }
}

/// How often the first numbers of two blocks lie in the same half, less a half: squared, mean over
/// samples. Of independent orders 1 / (2 kPoints): of each pair of points one lies in each half.
constexpr std::uint32_t kPoints = 256;
double mean_squared_bias(std::uint32_t a, std::uint32_t b) {
    constexpr std::uint32_t kSamples = 2000;
    const RandomKey key{5, Stream::kCacheA};
    double sum = 0;
    for (std::uint32_t sample = 0; sample < kSamples; ++sample) {
        double same = 0;
        for (std::uint32_t n = 0; n < kPoints; ++n)
            same += (sobol_uniforms(key, sample, n, a)[0] < 0.5f) ==
                    (sobol_uniforms(key, sample, n, b)[0] < 0.5f);
        const double bias = same / kPoints - 0.5;
        sum += bias * bias;
    }
    return sum / kSamples;
}

/// The bound is thirty standard deviations above what independent orders have.
TEST(Sobol, BlocksAreNoFunctionsOfEachOther) {
    constexpr double kBound = 1.0 / kPoints;
    constexpr std::uint32_t kLast = ~0u;
    for (const auto& [a, b] : std::initializer_list<std::pair<std::uint32_t, std::uint32_t>>{
             {0, 2}, {1, 2}, {1, 3}, {2, 3}, {2, 4}, {0, kLast}, {3, kLast}})
        EXPECT_LT(mean_squared_bias(a, b), kBound) << a << " " << b;
    EXPECT_EQ(mean_squared_bias(0, 1), 0.25);  // in one order
}

/// Whether four numbers of each of many seeds fill the cells of a grid evenly.
template <class Numbers>
double independence_p_value(const Numbers& numbers_of_seed) {
    constexpr std::uint32_t kSide = 4;
    const auto seeds = scaled(kSobol, std::uint32_t{1} << 16);
    std::vector<double> count(kSide * kSide * kSide * kSide, 0.0);
    for (std::uint32_t seed = 0; seed < seeds; ++seed) {
        std::size_t cell = 0;
        for (const float u : numbers_of_seed(seed))
            cell = cell * kSide + static_cast<std::size_t>(u * float{kSide});
        ++count[cell];
    }
    const double expected = seeds / static_cast<double>(count.size());
    return test::goodness_of_fit_p_value(count, std::vector<double>(count.size(), expected));
}

TEST(Sobol, NumbersAreIndependentOverTheSeeds) {
    constexpr std::uint32_t kPass = 21;
    const RandomKey half_a{seed_of(kSobol), Stream::kCacheA}, half_b{half_a.seed, Stream::kCacheB};
    const auto draw_of = [](RandomKey key, std::uint32_t pixel, std::uint32_t n,
                            std::uint32_t block) { return sobol_uniforms(key, pixel, n, block); };
    using Numbers = std::array<float, 4>;
    const auto first_two_of = [](const Numbers& a, const Numbers& b) {
        return Numbers{a[0], a[1], b[0], b[1]};
    };
    const auto compare = [&](const char* what, const auto& numbers) {
        EXPECT_TRUE(accepted(kSobol, what, independence_p_value(numbers)));
    };
    compare("first point", [&](std::uint32_t i) { return draw_of(half_a, i, 0, 0); });
    compare("another point, with its fifth number", [&](std::uint32_t i) {
        const Numbers u = draw_of(half_a, i, kPass, 1);
        return Numbers{u[0], u[1], u[2], sobol_fifth(half_a, i, kPass, 1)};
    });
    compare("techniques", [&](std::uint32_t i) {
        return first_two_of(draw_of(half_a, i, kPass, 0), draw_of(half_a, i, kPass, 1));
    });
    compare("pixels", [&](std::uint32_t i) {
        return first_two_of(draw_of(half_a, 2 * i, kPass, 0), draw_of(half_a, 2 * i + 1, kPass, 0));
    });
    compare("halves", [&](std::uint32_t i) {
        return first_two_of(draw_of(half_a, i, kPass, 0), draw_of(half_b, i, kPass, 0));
    });

    const auto defect = [&](const char* what, const auto& numbers) {
        EXPECT_TRUE(rejected(kSobol, what, independence_p_value(numbers)));
    };
    const auto x = sobol_reversed<0, 4>(kPass);
    const auto seeds_of = [&](std::uint32_t i) {
        return philox4x32(Counter{i, 0, 0, 0}, {half_a.seed, 0});
    };
    const auto number = [](std::uint32_t scrambled) {
        return to_unit_float(reverse_bits(scrambled));
    };
    defect("one seed for all dimensions", [&](std::uint32_t i) {
        Numbers u;
        for (std::size_t d = 0; d < 4; ++d) u[d] = number(scramble_reversed(x[d], seeds_of(i)[0]));
        return u;
    });
    defect("one stream for both halves", [&](std::uint32_t i) {
        return first_two_of(draw_of(half_a, i, kPass, 0), draw_of(half_a, i, kPass, 0));
    });
    defect("seed multiplied in place of added", [&](std::uint32_t i) {
        Numbers u;
        for (std::size_t d = 0; d < 4; ++d)
            u[d] = number(scramble_reversed(x[d] * (seeds_of(i)[d] | 1), 0u));
        return u;
    });
}

}  // namespace
}  // namespace burnish
