// Adaptive sampling: samples that are spent where pixels matter most. Exact: how many are expected,
// and which are drawn. Statistical: whatever is learnt from earlier iterations, every estimator
// agrees with the baseline at every iteration of a script. (Holm over iterations, texels, channels
// and random projections.)
#include "gradient/adaptive_sampling.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "gradient/candidates.h"
#include "gradient/estimator_script.h"
#include "render/film.h"

namespace burnish {
namespace {

using test::accepted;
using test::agreement_p_value;
using test::Estimates;
using test::follow;
using test::follow_baseline;
using test::gris;
using test::kScriptIterations;
using test::make_script;
using test::mc;
using test::name_of;
using test::numbers_of;
using test::pgris;
using test::pris;
using test::rejected;
using test::RunningMean;
using test::Runs;
using test::scaled;
using test::Script;
using test::seed_of;
using test::sum_runs;
using test::Tamper;
using test::ledger::kAdaptiveSampling;

// ---- How many samples are expected

/// The small scene, an adjoint, and what samples are said to have found.
struct Known {
    Scene scene = test::make_small_scene({.filter = FilterKind::kMitchell});
    Image adjoint;
    PixelStatistics statistics;

    explicit Known(bool learnt) {
        adjoint =
            normalized_adjoint(test::make_adjoint(scene, 31, true), film_normalization(scene.film));
        const Theta theta = test::theta_of(scene);
        const TracedScene traced = prepare(scene);
        statistics = make_pixel_statistics(Binding(traced, theta));
        test::RandomSource random{32};
        for (std::size_t i = 0; learnt && i < statistics.seen.size(); ++i)
            if (statistics.seen[i] && random.next() < 0.5f) {
                statistics.counts[i] = random.next(0, 5);
                statistics.squares[i] = std::pow(10.0f, random.next(-3, 3));
            }
    }
};

/// The root of |w|^2 E|g|^2 / |w|^2 of one pixel, by definition.
double size_of(const Known& known, int x, int y) {
    const Film& film = known.scene.film;
    double w_square = 0, square = 0, count = 0, all_squares = 0, all_counts = 0;
    for (const float across : {0.25f, 0.75f})
        for (const float down : {0.25f, 0.75f}) {
            const Rgbf w = adjoint_weight(known.adjoint, x, y, filter_taps(film.filter, across),
                                          filter_taps(film.filter, down));
            w_square += 0.25 * double{dot(w, w)};
        }
    for (int j = 0; j < film.crop_height; ++j)
        for (int i = 0; i < film.crop_width; ++i) {
            const auto at = static_cast<std::size_t>(j * film.crop_width + i);
            const double s = double{known.statistics.squares[at]},
                         c = double{known.statistics.counts[at]};
            all_squares += s, all_counts += c;
            if (std::abs(i - x) <= 2 && std::abs(j - y) <= 2) square += s, count += c;
        }
    if (all_counts == 0) return std::sqrt(w_square);
    return std::sqrt(w_square * (square + all_squares / all_counts) / (count + 1));
}

void expect_in_proportion(const Known& known, float mean) {
    const Film& film = known.scene.film;
    const std::vector<float> e = expected_samples(film, known.adjoint, mean, known.statistics);
    const float min = kUniformShare * mean, max = static_cast<float>(kMaxOfMean) * mean;
    double sum = 0, factor = 0;
    std::size_t seen = 0, limited = 0;
    for (int y = 0; y < film.crop_height; ++y)
        for (int x = 0; x < film.crop_width; ++x) {
            const auto i = static_cast<std::size_t>(y * film.crop_width + x);
            sum += double{e[i]};
            if (!known.statistics.seen[i]) {
                EXPECT_EQ(e[i], 0.0f);
                continue;
            }
            ++seen;
            EXPECT_GE(e[i], min);
            EXPECT_LE(e[i], max);
            if (e[i] >= max) {
                ++limited;
                continue;
            }
            const double f = (double{e[i]} - double{min}) / size_of(known, x, y);
            if (factor == 0) factor = f;
            EXPECT_NEAR(f, factor, 1e-4 * factor) << x << ", " << y;
        }
    EXPECT_NEAR(sum, double{mean} * static_cast<double>(seen), 1e-4 * sum);
    EXPECT_LT(seen, e.size()) << "the scene has pixels that see no texture";
    EXPECT_LT(limited, seen);
}

TEST(AdaptiveSampling, ExpectsSamplesInProportionToAPixelsPart) {
    for (const float mean : {1.0f, 3.0f}) {
        expect_in_proportion(Known(false), mean);
        expect_in_proportion(Known(true), mean);
    }
}

TEST(AdaptiveSampling, LimitsThePixelThatMattersMostAndGivesTheRestToOthers) {
    Known known(false);
    std::fill(known.adjoint.values.begin(), known.adjoint.values.end(), 1e-3f);
    for (int c = 0; c < 3; ++c) known.adjoint.at(7, 8, c) = 1e3f;
    const Film& film = known.scene.film;
    const std::vector<float> e = expected_samples(film, known.adjoint, 1, known.statistics);
    EXPECT_FLOAT_EQ(e[8 * 16 + 7], static_cast<float>(kMaxOfMean));
    double sum = 0;
    for (const float x : e) sum += double{x};
    const auto seen = std::count(known.statistics.seen.begin(), known.statistics.seen.end(), 1);
    EXPECT_NEAR(sum, static_cast<double>(seen), 1e-3);
}

TEST(AdaptiveSampling, IsEvenWhereNoPixelMatters) {
    Known known(true);
    std::fill(known.adjoint.values.begin(), known.adjoint.values.end(), 0.0f);
    const std::vector<float> e =
        expected_samples(known.scene.film, known.adjoint, 2, known.statistics);
    for (std::size_t i = 0; i < e.size(); ++i)
        EXPECT_EQ(e[i], known.statistics.seen[i] ? 2.0f : 0.0f);
}

TEST(AdaptiveSampling, DrawsAsManySamplesAsExpectedInPassesOfTheirOwn) {
    const Film film{20, 40, 0, 0, 20, 40, {}};
    constexpr std::uint32_t kPasses = 16;
    std::vector<float> expected(800);
    test::RandomSource random{33};
    for (float& e : expected) e = std::max(0.0f, random.next(-2, 16));
    expected[5] = 16;
    const auto samples = choose_samples(film, expected, 7, 3, kPasses);
    std::vector<std::set<std::uint32_t>> passes(expected.size());
    std::set<std::uint32_t> first_passes;
    for (const BatchSample& s : samples) {
        EXPECT_EQ(s.camera.iteration, 3u);
        EXPECT_LT(s.camera.pass, kPasses);
        if (passes[s.camera.pixel].empty()) first_passes.insert(s.camera.pass);
        EXPECT_TRUE(passes[s.camera.pixel].insert(s.camera.pass).second) << "a sample twice";
    }
    EXPECT_EQ(first_passes.size(), kPasses) << "a pixel's passes begin anywhere";
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_GE(static_cast<float>(passes[i].size()), std::floor(expected[i]));
        EXPECT_LE(static_cast<float>(passes[i].size()), std::ceil(expected[i]));
    }
    EXPECT_EQ(passes[5].size(), 16u);
}

TEST(AdaptiveSampling, CountsOldSamplesForLess) {
    PixelStatistics statistics{{1, 1}, {0, 0}, {0, 0}};
    const BatchSample first{{0, 0, 0}}, second{{1, 0, 0}};
    const PixelSquare large{0, 8}, small{0, 2};
    update_statistics(std::vector{first, first, second}, std::vector{large, small}, statistics);
    EXPECT_EQ(statistics.counts, (std::vector<float>{2, 1}));
    EXPECT_EQ(statistics.squares, (std::vector<float>{10, 0}));
    update_statistics(std::vector{second}, std::vector<PixelSquare>{}, statistics);
    EXPECT_EQ(statistics.counts, (std::vector<float>{2 * 0.9f, 0.9f + 1}));
    EXPECT_EQ(statistics.squares, (std::vector<float>{9, 0}));
}

// ---- The baseline from its parts

/// Of one iteration: the camera samples, what they are worth, and the adjoint.
struct Parts {
    std::vector<BatchSample> samples;
    std::vector<float> shares;  ///< of a pixel's samples
};

Parts parts_of(const Script& script, std::size_t v, const Binding& binding, std::uint32_t seed,
               PixelStatistics statistics) {
    if (statistics.seen.empty()) statistics = make_pixel_statistics(binding);
    const Film& film = script.scene.film;
    Parts parts;
    parts.shares = expected_samples(
        film, normalized_adjoint(script.adjoint[v], film_normalization(film)), 1.0f, statistics);
    parts.samples =
        choose_samples(film, parts.shares, seed, static_cast<std::uint32_t>(v), kMaxOfMean);
    for (float& s : parts.shares) s = s > 0 ? 1 / s : 0;
    return parts;
}

/// The sum over all light and BSDF samples of the camera samples.
std::vector<TexelGradient> sum_of(const Script& script, std::size_t v, const Binding& binding,
                                  std::uint32_t seed, const Parts& parts) {
    const Film& film = script.scene.film;
    const RandomKey key{seed, Stream::kDerivative};
    const PassTaps taps =
        pass_taps(film.filter, key, static_cast<std::uint32_t>(v) * kMaxOfMean, kMaxOfMean);
    const Image weights = normalized_adjoint(script.adjoint[v], film_normalization(film));
    const auto paths = trace_paths({&binding.traced, &binding.textures, key, kMaxOfMean,
                                    SurfaceChoice::kUnknown, binding.unknown_bsdfs, true},
                                   parts.samples)
                           .paths;
    std::map<TexelKey, Rgbf> sums;
    TexelDerivatives texels;
    for (const TracedPath& p : paths) {
        differentiate({&binding, &weights, &taps, TargetFunction::kIntegrand}, p.record, texels);
        for (int k = 0; k < texels.count; ++k) {
            const TexelDerivative& d = texels.items[static_cast<std::size_t>(k)];
            sums[d.key] += d.g * parts.shares[p.record.pixel];
        }
    }
    std::vector<TexelGradient> gradient;
    for (const auto& [texel, g] : sums) gradient.push_back({texel, g});
    return gradient;
}

MonteCarlo adaptive(MonteCarlo options) {
    options.adaptive_sampling = true;
    return options;
}

Reservoirs adaptive(Reservoirs options) {
    options.adaptive_sampling = true;
    options.target_function = TargetFunction::kIntegrand;
    options.confidence_cap = 4;
    return options;
}

/// One estimate of the baseline.
GradientResult next(const Script& script, std::size_t v, const Binding& binding,
                    const MonteCarlo& options, std::uint32_t seed, MonteCarloState& state) {
    return estimate_gradient(options, binding, script.adjoint[v], seed,
                             static_cast<std::uint32_t>(v), state);
}

TEST(AdaptiveSampling, TheBaselineIsTheSumOfItsParts) {
    const Script script = make_script(false);
    const TracedScene traced = prepare(script.scene);
    constexpr std::uint32_t kSeed = 3;
    MonteCarloState state;
    for (std::size_t v = 0; v < kScriptIterations; ++v) {
        const Binding binding(traced, script.theta[v]);
        const auto expected = numbers_of(
            script.theta[v],
            sum_of(script, v, binding, kSeed, parts_of(script, v, binding, kSeed, state.pixels)));
        const auto result = next(script, v, binding, adaptive(mc()), kSeed, state);
        const auto numbers = numbers_of(script.theta[v], result.gradient);
        double largest = 0;
        for (const double g : expected) largest = std::max(largest, std::abs(g));
        for (std::size_t i = 0; i < numbers.size(); ++i)
            EXPECT_NEAR(numbers[i], expected[i], 1e-5 * largest);
    }
    EXPECT_FALSE(state.pixels.seen.empty()) << "what was learnt goes on";
}

// ---- Unbiasedness

/// Changes what the samples of an iteration are worth.
using Misjudge = void (*)(Parts& parts);

/// Defect: a sample counts 1 / m wherever it is.
void count_alike(Parts& parts) { std::fill(parts.shares.begin(), parts.shares.end(), 1.0f); }

/// Defect: a sample counts 1 / n_j, the number that came, in place of 1 / e_j.
void count_realised(Parts& parts) {
    std::vector<float> counts(parts.shares.size());
    for (const BatchSample& s : parts.samples) ++counts[s.camera.pixel];
    for (std::size_t i = 0; i < counts.size(); ++i)
        parts.shares[i] = counts[i] > 0 ? 1 / counts[i] : 0;
}

/// Runs of the baseline along the script with a defect.
Estimates follow_misjudged(const Script& script, Misjudge misjudge) {
    const TracedScene traced = prepare(script.scene);
    Runs runs(scaled(kAdaptiveSampling, std::size_t{200}));
    parallel_for(runs.size(), [&](std::size_t run) {
        const std::uint32_t seed = seed_of(kAdaptiveSampling, static_cast<std::uint32_t>(run));
        MonteCarloState state;
        for (std::size_t v = 0; v < kScriptIterations; ++v) {
            const Binding binding(traced, script.theta[v]);
            Parts parts = parts_of(script, v, binding, seed, state.pixels);
            misjudge(parts);
            next(script, v, binding, adaptive(mc()), seed, state);
            runs[run].push_back(
                numbers_of(script.theta[v], sum_of(script, v, binding, seed, parts)));
        }
    });
    return sum_runs(runs);
}

/// Defect: the lower half of the picture, which sees the floor, is taken for one that does not.
void blind_half(ReservoirsState& state, std::size_t) {
    std::vector<char>& seen = state.pixels.seen;
    std::fill(seen.begin() + static_cast<std::ptrdiff_t>(seen.size() / 2), seen.end(), char{0});
}

TEST(AdaptiveSampling, EstimatorsAgreeWithTheBaselineAtEveryIteration) {
    const Script script = make_script(false);
    const Estimates baseline = follow_baseline(kAdaptiveSampling, script);
    const auto p_value = [&](const Estimator& e, const Tamper& tamper = {}) {
        return agreement_p_value(follow(kAdaptiveSampling, script, e, tamper), baseline);
    };
    for (const Estimator& e : {Estimator{adaptive(mc())}, Estimator{adaptive(pris())},
                               Estimator{adaptive(gris())}, Estimator{adaptive(pgris())}})
        EXPECT_TRUE(accepted(kAdaptiveSampling, name_of(e), p_value(e)));
    Reservoirs identity = adaptive(pgris());
    identity.shift = Shift::kIdentity;
    identity.samples = 2;
    EXPECT_TRUE(accepted(kAdaptiveSampling, "pgris, identity, two samples", p_value(identity)));

    EXPECT_TRUE(rejected(kAdaptiveSampling, "all samples count alike",
                         agreement_p_value(follow_misjudged(script, count_alike), baseline)));
    EXPECT_TRUE(rejected(kAdaptiveSampling, "samples divided by how many came",
                         agreement_p_value(follow_misjudged(script, count_realised), baseline)));
    EXPECT_TRUE(rejected(kAdaptiveSampling, "pixels left out that see a texture",
                         p_value(adaptive(pgris()), blind_half)));
}

}  // namespace
}  // namespace burnish
