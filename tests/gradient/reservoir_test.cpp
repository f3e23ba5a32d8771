// Reservoirs and their merge, on integrals over [0, 1) whose value is known. What is tested is the
// frequency of selection and E[f W], before and after merging: an image or a plain average does not
// see a reservoir that selects wrongly.
#include "gradient/reservoirs/reservoir.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "gradient/reservoirs/merge.h"
#include "ledger_entries.h"
#include "random_source.h"
#include "student.h"
#include "worst.h"

namespace burnish {
namespace {

using test::RandomSource;
using test::RunningMean;

using test::accepted;
using test::rejected;
using test::scaled;
using test::seed_of;
using namespace test::ledger;

// ---- Updates: the one under test, and one with a classic defect

struct RightUpdate {
    template <class S>
    void operator()(ReservoirBuilder<S>& b, const S& s, float q, double w, double u) const {
        update(b, s, q, w, u);
    }
};

/// Compares with the sum of the weights *before* the sample: w / w_old.
struct KeepsByOldSum {
    template <class S>
    void operator()(ReservoirBuilder<S>& b, const S& s, float q, double w, float u) const {
        if (!(w > 0)) return;
        if (double{u} * b.weight_sum < w) b.sample = s, b.q = q;
        b.weight_sum += w;
    }
};

/// p-value of "index i is kept with probability w_i / sum w".
template <class Update>
double selection_p_value(const Update& offer, std::uint32_t seed) {
    const std::vector<double> weights{0.1, 2.0, 0.5, 0.0, 3.0, 1.0, 0.05, 0.35};
    const int runs = scaled(kSelection, 200000);
    RandomSource random{seed};
    std::vector<double> observed(weights.size()), expected(weights.size());
    for (int run = 0; run < runs; ++run) {
        ReservoirBuilder<std::size_t> builder;
        for (std::size_t i = 0; i < weights.size(); ++i)
            offer(builder, i, 1.0f, weights[i], random.next());
        ++observed[finish(builder).sample];
    }
    for (std::size_t i = 0; i < weights.size(); ++i) expected[i] = runs * weights[i] / 7.0;
    return test::goodness_of_fit_p_value(observed, expected);
}

TEST(Reservoir, KeepsASampleInProportionToItsWeight) {
    EXPECT_TRUE(
        accepted(kSelection, "frequency", selection_p_value(RightUpdate{}, seed_of(kSelection))));
    EXPECT_TRUE(rejected(kSelection, "keep with probability w / w_old",
                         selection_p_value(KeepsByOldSum{}, seed_of(kSelection))));
}

TEST(Reservoir, IgnoresWeightsThatAreNotPositiveAndFinite) {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    ReservoirBuilder<int> builder;
    update(builder, 7, -2.0f, 3.0, 0.9f);
    for (const double bad : {0.0, -1.0, kInf, -kInf, std::nan("")})
        update(builder, 8, 5.0f, bad, 0.0f);
    EXPECT_EQ(builder.sample, 7);
    EXPECT_EQ(builder.q, -2.0f);
    EXPECT_EQ(builder.weight_sum, 3.0);
    EXPECT_EQ(finish(builder).W, 1.5f);
    EXPECT_EQ(finish(ReservoirBuilder<int>{}).W, 0.0f);
}

TEST(Reservoir, SortsSamplesBySign) {
    EXPECT_EQ(slot_of(Signs::kPositivized, 1.0f), 0);
    EXPECT_EQ(slot_of(Signs::kPositivized, -1.0f), 1);
    EXPECT_EQ(slot_of(Signs::kAbsolute, -1.0f), 0);
}

// ---- A sequence of integrands q_v(x) whose sign flips from one iteration to the next [PR fig. 3],
// ---- and, in the last ones, whose zeros move: the history has no sample where the target was 0

constexpr int kChainIterations = 8;
constexpr float kHit = 0.3f;  // candidates per iteration: most iterations have none

float sign_of_iteration(int v) { return v % 2 == 0 ? 1.0f : -1.0f; }

bool is_zero(int v, float x) {
    return v >= kChainIterations - 3 && (v % 2 == 0 ? x < 0.3f : x > 0.7f);
}

/// Signed target at iteration v; -1: the one before the first, never read with a confidence.
float target(int v, float x) {
    if (is_zero(v, x)) return 0;
    constexpr std::array<float, kChainIterations> kSize{1.0f, 0.8f, 1.1f, 0.9f,
                                                        0.7f, 1.2f, 1.0f, 0.8f};
    const auto i = static_cast<std::size_t>(std::max(v, 0));
    const float phase = 0.07f * static_cast<float>(v);
    return sign_of_iteration(v) * kSize[i] *
           (std::sin(2 * std::numbers::pi_v<float> * (x + phase)) + 0.25f);
}

/// f / q is bounded but not constant, so a wrong selection is a wrong expectation.
float integrand(int v, float x) { return target(v, x) * (0.25f + 2 * x); }

/// Density of the candidates of iteration v: a different one in each.
float candidate_pdf(int v, float x) { return 1.0f + 0.5f * sign_of_iteration(v) * (2 * x - 1); }

float draw_candidate(int v, float u) {
    const float k = 0.5f * sign_of_iteration(v);  // solves (1 - k) x + k x^2 = u
    const float b = 1 - k;
    return (-b + std::sqrt(b * b + 4 * k * u)) / (2 * k);
}

double integral(int v) {
    constexpr int kSteps = 100000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
        sum += double{integrand(v, (static_cast<float>(i) + 0.5f) / kSteps)};
    return sum / kSteps;
}

// ---- Chaining with defects

enum class Defect {
    kNone,
    kKeepsByOldSum,      ///< the merge selects with w / w_old
    kCountsHitsOnly,     ///< M grows only in iterations that hit the parameter
    kConfidencePerSign,  ///< M grows per sign, where that sign's reservoir is not empty
    kDropsFlipped,       ///< history whose sign flipped is thrown away
    kRescalesW,          ///< W multiplied by the ratio of the candidates' densities
};

const char* name_of(Defect defect) {
    switch (defect) {
        case Defect::kNone:
            return "none";
        case Defect::kKeepsByOldSum:
            return "merge keeps with w / w_old";
        case Defect::kCountsHitsOnly:
            return "M counted per hit";
        case Defect::kConfidencePerSign:
            return "confidence per sign";
        case Defect::kDropsFlipped:
            return "history dropped where its sign flipped";
        case Defect::kRescalesW:
            return "W rescaled by a ratio of densities";
    }
    return "";
}

using Input = MergeInput<float>;
using Pair = ReservoirPair<float>;

/// merge(), written out once more, with another update.
template <class Weights, class Update>
Pair merge_with_update(std::span<const Input> current, std::span<const Input> history,
                       const Confidence& c, const Weights& weights, std::span<const float> u,
                       const Update& offer) {
    ReservoirPairBuilder<float> builder;
    std::size_t direct_sample = 0;
    const auto feed = [&](const Input& y, float m) {
        const double w = double{m} * std::fabs(double{y.q_now}) * double{y.W};
        offer(builder.slot[slot_of(Signs::kPositivized, y.q_now)], y.sample, y.q_now, w,
              u[direct_sample++]);
    };
    for (const Input& y : current) feed(y, weights(y.q_now, y.q_before, c).current);
    for (const Input& y : history) feed(y, weights(y.q_now, y.q_before, c).history);
    return finish(builder);
}

/// They add up to one, but count on the history where it cannot have a sample.
struct ConstantWeights {
    MisWeights operator()(float, float, const Confidence& c) const {
        const float sum = c.current + c.history;
        return {c.current / sum, c.history / sum};
    }
};

/// Balance weights whose confidences depend on the sign of each target.
struct PerSignWeights {
    std::array<float, 2> current, history;
    MisWeights operator()(float q_now, float q_before, const Confidence&) const {
        const Confidence c{current[q_now < 0], history[q_before < 0]};
        return BalanceWeights{}(q_now, q_before, c);
    }
};

struct MergeChain {
    Pair pair;
    float confidence = 0;
    std::array<float, 2> sign_confidence{};
};

constexpr float kCap = 4;

/// The reservoirs of this iteration's candidates alone: one candidate, with probability kHit.
Pair current_pair(int v, Signs signs, RandomSource& random) {
    ReservoirPairBuilder<float> builder;
    if (random.next() < kHit) {
        const float x = draw_candidate(v, random.next()), q = target(v, x);
        update(builder.slot[slot_of(signs, q)], x, q,
               std::fabs(double{q}) / double{candidate_pdf(v, x)}, random.next());
    }
    return finish(builder);
}

std::vector<Input> inputs_of(const Pair& pair, int v, Defect defect, bool history) {
    std::vector<Input> inputs;
    for (const auto& r : pair.slot) {
        if (!(r.W > 0)) continue;
        Input y{r.sample, target(v, r.sample), target(v - 1, r.sample), r.W};
        if (history && defect == Defect::kDropsFlipped && y.q_now * y.q_before < 0) y.W = 0;
        if (history && defect == Defect::kRescalesW)
            y.W *= candidate_pdf(v - 1, r.sample) / candidate_pdf(v, r.sample);
        inputs.push_back(y);
    }
    return inputs;
}

template <class Weights>
void advance(MergeChain& chain, int v, Signs signs, Defect defect, const Weights& weights,
             RandomSource& random) {
    const Pair fresh = current_pair(v, signs, random);
    const bool hit = fresh.slot[0].W > 0 || fresh.slot[1].W > 0;
    Confidence c{1.0f, std::min(chain.confidence, kCap)};
    if (defect == Defect::kCountsHitsOnly) c.current = hit ? 1.0f : 0.0f;
    PerSignWeights per_sign{
        {fresh.slot[0].W > 0 ? 1.0f : 0.0f, fresh.slot[1].W > 0 ? 1.0f : 0.0f},
        {std::min(chain.sign_confidence[0], kCap), std::min(chain.sign_confidence[1], kCap)}};
    const auto current = inputs_of(fresh, v, defect, false);
    const auto history = v == 0 ? std::vector<Input>{} : inputs_of(chain.pair, v, defect, true);
    const std::array<float, 4> u{random.next(), random.next(), random.next(), random.next()};
    if (defect == Defect::kKeepsByOldSum)
        chain.pair = merge_with_update(current, history, c, weights, u, KeepsByOldSum{});
    else if (defect == Defect::kConfidencePerSign)
        chain.pair = merge<float>(current, history, c, signs, per_sign, u);
    else
        chain.pair = merge<float>(current, history, c, signs, weights, u);
    chain.confidence = c.current + c.history;
    for (std::size_t s = 0; s < 2; ++s)
        chain.sign_confidence[s] = per_sign.current[s] + per_sign.history[s];
}

/// Holm-corrected p-value of "E[f W] is the integral at every iteration".
template <class Weights>
double chain_p_value(Signs signs, Defect defect, const Weights& weights, std::uint32_t seed) {
    const int runs = scaled(kChain, 200000);
    std::array<RunningMean, kChainIterations> means;
    RandomSource random{seed};
    for (int run = 0; run < runs; ++run) {
        MergeChain chain;
        for (int v = 0; v < kChainIterations; ++v) {
            advance(chain, v, signs, defect, weights, random);
            means[static_cast<std::size_t>(v)].add(estimate(
                chain.pair, [&](float x) { return double{integrand(v, x)}; }, 0.0));
        }
    }
    std::vector<double> p;
    for (int v = 0; v < kChainIterations; ++v) {
        const RunningMean& m = means[static_cast<std::size_t>(v)];
        p.push_back(test::mean_p_value(m.mean, m.standard_error(), double{kHit} * integral(v)));
    }
    return test::holm_minimum(p);
}

TEST(Merge, IsUnbiasedAtEveryIterationWhileTheTargetFlipsItsSign) {
    const auto check = [](const char* what, Signs signs, const auto& weights, std::uint32_t seed) {
        EXPECT_TRUE(accepted(kChain, what,
                             chain_p_value(signs, Defect::kNone, weights, seed_of(kChain, seed))));
    };
    check("positivised, balance", Signs::kPositivized, BalanceWeights{}, 0);
    check("positivised, defensive", Signs::kPositivized, DefensiveWeights{}, 1);
    check("absolute, balance", Signs::kAbsolute, BalanceWeights{}, 2);
    check("absolute, defensive", Signs::kAbsolute, DefensiveWeights{}, 3);
}

TEST(Merge, DefectsOfTheChainAreRejected) {
    for (const Defect defect :
         {Defect::kKeepsByOldSum, Defect::kCountsHitsOnly, Defect::kConfidencePerSign,
          Defect::kDropsFlipped, Defect::kRescalesW})
        EXPECT_TRUE(rejected(
            kChain, name_of(defect),
            chain_p_value(Signs::kPositivized, defect, BalanceWeights{}, seed_of(kChain))));
    for (const Defect defect : {Defect::kKeepsByOldSum, Defect::kDropsFlipped, Defect::kRescalesW})
        EXPECT_TRUE(rejected(
            kChain, name_of(defect),
            chain_p_value(Signs::kPositivized, defect, DefensiveWeights{}, seed_of(kChain, 1))));
    EXPECT_TRUE(rejected(
        kChain, "weights that are constant",
        chain_p_value(Signs::kPositivized, Defect::kNone, ConstantWeights{}, seed_of(kChain))));
}

// ---- Before merging

/// p-value of "E[f W] over M candidates is the integral".
template <class Update>
double resampled_p_value(Signs signs, int candidates, const Update& offer, std::uint32_t seed) {
    const int runs = scaled(kFreshReservoir, 200000);
    RandomSource random{seed};
    RunningMean mean;
    for (int run = 0; run < runs; ++run) {
        ReservoirPairBuilder<float> builder;
        for (int k = 0; k < candidates; ++k) {
            const float x = draw_candidate(0, random.next()), q = target(0, x);
            offer(builder.slot[slot_of(signs, q)], x, q,
                  std::fabs(double{q}) / double{candidate_pdf(0, x)} / candidates, random.next());
        }
        mean.add(estimate(
            finish(builder), [](float x) { return double{integrand(0, x)}; }, 0.0));
    }
    return test::mean_p_value(mean.mean, mean.standard_error(), integral(0));
}

TEST(Reservoir, EstimateIsUnbiasedBeforeMerging) {
    for (const Signs signs : {Signs::kPositivized, Signs::kAbsolute})
        for (const int candidates : {1, 2, 8}) {
            const std::uint32_t seed = seed_of(kFreshReservoir);
            const std::string name = std::string(signs == Signs::kAbsolute ? "ris" : "pris") +
                                     ", M " + std::to_string(candidates);
            EXPECT_TRUE(accepted(kFreshReservoir, name,
                                 resampled_p_value(signs, candidates, RightUpdate{}, seed)));
            if (candidates == 8) {
                EXPECT_TRUE(rejected(kFreshReservoir, "keep with probability w / w_old",
                                     resampled_p_value(signs, candidates, KeepsByOldSum{}, seed)));
            }
        }
}

// ---- Weights of the merge

constexpr double kRounding = 1.2e-7;  // two floats, each rounded once

/// The largest |m_current + m_history - 1| over a grid of targets and confidences.
template <class Weights>
double worst_sum(const Weights& weights, bool with_zero_now) {
    double worst = 0;
    for (const float now : {-3.0f, -1e-20f, 0.0f, 1e-30f, 0.7f, 4e18f})
        for (const float before : {-2e19f, -0.5f, 0.0f, 1e-25f, 0.7f, 8.0f})
            for (const float c : {0.0f, 1.0f, 16.0f, 32.0f}) {
                if (now == 0 && (!with_zero_now || before == 0 || c == 0)) continue;
                const MisWeights m = weights(now, before, Confidence{2.0f, c});
                worst = test::worse(worst, std::fabs(double{m.current} + double{m.history} - 1));
            }
    return worst;
}

/// Caps the history in the numerator but not in the denominator.
struct UncappedDenominator {
    MisWeights operator()(float q_now, float q_before, const Confidence& c) const {
        const MisWeights m = BalanceWeights{}(q_now, q_before, {c.current, 2 * c.history});
        return {m.current, m.history / 2};
    }
};

TEST(MergeWeights, SumToOne) {
    EXPECT_LE(worst_sum(BalanceWeights{}, true), kRounding);
    EXPECT_LE(worst_sum(DefensiveWeights{}, false), kRounding);
    EXPECT_GT(worst_sum(UncappedDenominator{}, false), kRounding);
}

/// The largest |m_history| where the history can have no sample.
template <class Weights>
double worst_without_history(const Weights& weights) {
    double worst = 0;
    for (const float now : {-3.0f, -1e-20f, 0.0f, 1e-30f, 0.7f, 4e18f})
        for (const auto& [before, confidence] :
             {std::pair{0.0f, 1.0f}, {0.0f, 32.0f}, {-0.5f, 0.0f}, {2e19f, 0.0f}}) {
            const MisWeights m = weights(now, before, Confidence{2.0f, confidence});
            worst = test::worse(worst, std::fabs(double{m.history}));
        }
    return worst;
}

TEST(MergeWeights, GiveTheHistoryNothingWhereItCanHaveNoSample) {
    EXPECT_EQ(worst_without_history(BalanceWeights{}), 0);
    EXPECT_EQ(worst_without_history(DefensiveWeights{}), 0);
    EXPECT_GT(worst_without_history(ConstantWeights{}), 0);
    EXPECT_LE(worst_sum(ConstantWeights{}, false), kRounding) << "their sum alone does not tell";
}

TEST(MergeWeights, AreNothingWhereBothTargetsAre) {
    const MisWeights m = BalanceWeights{}(0.0f, 0.0f, Confidence{1.0f, 16.0f});
    EXPECT_EQ(m.current, 0.0f);
    EXPECT_EQ(m.history, 0.0f);
}

TEST(MergeWeights, DefensiveOnesNeverAmplifyHistory) {
    RandomSource random{401};
    for (int i = 0; i < 1000; ++i) {
        const float now = random.next(-2, 2), before = random.next(-2, 2);
        const Confidence c{1.0f, random.next(0, 32)};
        if (now == 0 || before == 0) continue;
        // The history's weight relative to its w_sum: m |q_now| / |q_before|.
        const auto gain = [&](const MisWeights& m) {
            return double{m.history} * std::fabs(double{now} / double{before});
        };
        EXPECT_LE(gain(DefensiveWeights{}(now, before, c)), 1.0 + 1e-6);
    }
    const MisWeights balance = BalanceWeights{}(2.0f, 0.01f, Confidence{1.0f, 16.0f});
    EXPECT_GT(double{balance.history} * 200, 1.0);  // the balance heuristic does
}

// ---- Variance: positivised resampling converges, resampling with |q| stops [PR eq. 7, 11]

constexpr int kReservoirBatches = 200;  // as many as tell the skewness

/// A sign-changing integrand that is its own target, with uniform candidates.
float signed_wave(float x) { return std::sin(2 * std::numbers::pi_v<float> * x) + 0.25f; }

/// The sample variance of the estimate from M candidates, over one batch of runs.
double batch_variance(Signs signs, int candidates, RandomSource& random) {
    RunningMean mean;
    for (int run = 0; run < scaled(kVariance, 4000); ++run) {
        ReservoirPairBuilder<float> builder;
        for (int k = 0; k < candidates; ++k) {
            const float x = random.next(), q = signed_wave(x);
            update(builder.slot[slot_of(signs, q)], x, q, std::fabs(double{q}) / candidates,
                   random.next());
        }
        mean.add(estimate(
            finish(builder), [](float x) { return double{signed_wave(x)}; }, 0.0));
    }
    return mean.variance();
}

/// Slope of log variance over log M, by least squares.
double variance_slope(Signs signs, RandomSource& random) {
    double sx = 0, sy = 0, sxx = 0, sxy = 0, n = 0;
    for (int candidates = 1; candidates <= 32; candidates *= 2) {
        const double x = std::log(double{1} * candidates);
        const double y = std::log(batch_variance(signs, candidates, random));
        sx += x, sy += y, sxx += x * x, sxy += x * y, ++n;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

double slope_p_value(Signs signs, double expected, std::uint32_t seed) {
    RandomSource random{seed};
    RunningMean slope;
    for (int b = 0; b < kReservoirBatches; ++b) slope.add(variance_slope(signs, random));
    return test::welch_p_value(test::estimate_of(slope), {expected, 0.0});
}

TEST(Variance, OfPositivisedResamplingFallsAsOneOverM) {
    const std::uint32_t seed = seed_of(kVariance);
    EXPECT_TRUE(accepted(kVariance, "slope", slope_p_value(Signs::kPositivized, -1, seed)));
    EXPECT_TRUE(
        rejected(kVariance, "ris in place of pris", slope_p_value(Signs::kAbsolute, -1, seed)));
}

/// p-value of [PR eq. 7]: V[f / p] / M + (1 - 1 / M) V[f / |f|*].
double floor_p_value(Signs signs, int candidates, std::uint32_t seed) {
    double mean = 0, absolute = 0, square = 0;
    constexpr int kSteps = 1000000;
    for (int i = 0; i < kSteps; ++i) {
        const double f = double{signed_wave((static_cast<float>(i) + 0.5f) / kSteps)};
        mean += f / kSteps, absolute += std::fabs(f) / kSteps, square += f * f / kSteps;
    }
    const double m = candidates, floor = absolute * absolute - mean * mean;
    RandomSource random{seed};
    RunningMean variance;
    for (int b = 0; b < kReservoirBatches; ++b)
        variance.add(batch_variance(signs, candidates, random));
    return test::welch_p_value(test::estimate_of(variance),
                               {(square - mean * mean) / m + (1 - 1 / m) * floor, 0.0});
}

TEST(Variance, OfResamplingWithAbsoluteTargetStopsAtItsFloor) {
    const std::uint32_t seed = seed_of(kVariance, 1), other = seed_of(kVariance, 2);
    EXPECT_TRUE(accepted(kVariance, "M 16", floor_p_value(Signs::kAbsolute, 16, seed)));
    EXPECT_TRUE(accepted(kVariance, "M 64", floor_p_value(Signs::kAbsolute, 64, other)));
    EXPECT_TRUE(
        rejected(kVariance, "pris in place of ris", floor_p_value(Signs::kPositivized, 16, seed)));
}

}  // namespace
}  // namespace burnish
