// The decay rates of Adam: what losses tell, and of what they are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "experiments/decay_rates.h"
#include "experiments/experiments.h"
#include "experiments/small_target_scene.h"
#include "experiments/unique_rows.h"
#include "random_source.h"

namespace burnish {
namespace {

using Losses = std::vector<double>;

TEST(DecayRates, HoldWhereTheIntervalIsBelowOneAndTheSpreadIsSmall) {
    const Losses mc{1, 1.1, 1.2, 1};
    const DecayComparison narrow = compare_decay(Losses{0.5, 0.52, 0.54, 0.51}, mc);
    EXPECT_EQ(narrow.verdict, Verdict::kHolds);
    EXPECT_EQ(narrow.wins, 4);
    EXPECT_NEAR(narrow.spread_percent, 8, 1e-9);
    EXPECT_EQ(compare_decay(Losses{0.5, 0.6, 0.5, 0.5}, mc).verdict, Verdict::kPartly) << "wide";
}

TEST(DecayRates, FailWhereTheIntervalIsAboveOneWhateverTheSpread) {
    const Losses mc{1, 1.1, 1.2, 1};
    EXPECT_EQ(compare_decay(Losses{2, 2, 2, 2}, mc).verdict, Verdict::kFails) << "narrow";
    EXPECT_EQ(compare_decay(Losses{2, 3, 2, 3}, mc).verdict, Verdict::kFails);
}

// Losses of one mean with 5 % of noise: the range of nine is some 15 %.
TEST(DecayRates, DoNotFailByTheSpreadOfNoise) {
    test::RandomSource random{31};
    const auto noisy_losses = [&] {
        Losses losses;
        for (int k = 0; k < 9; ++k) {
            double normal = 0;  // about so: a sum of uniforms, of variance 1
            for (int i = 0; i < 12; ++i) normal += double{random.next(-0.5f, 0.5f)};
            losses.push_back(1 + 0.05 * normal);
        }
        return losses;
    };
    int wide = 0;
    for (int run = 0; run < 1000; ++run) {
        const DecayComparison c = compare_decay(noisy_losses(), noisy_losses());
        wide += c.spread_percent >= 10;
        EXPECT_EQ(c.verdict == Verdict::kFails, c.ratio.low > 1) << run;
        if (c.ratio.high < 1) {
            EXPECT_EQ(c.verdict, c.spread_percent < 10 ? Verdict::kHolds : Verdict::kPartly) << run;
        }
    }
    EXPECT_GT(wide, 500);
}

TEST(DecayRates, AreUndecidedWhereTheIntervalIs) {
    const Losses mc{1, 1, 1, 1};
    const DecayComparison close = compare_decay(Losses{0.98, 0.99, 0.99, 1.02}, mc);
    EXPECT_EQ(close.verdict, Verdict::kUndecided);
    EXPECT_EQ(close.wins, 3);
}

TEST(DecayRates, AreUndecidedWhereALossIsNoise) {
    const DecayComparison noise =
        compare_decay(Losses{-0.5, -0.5, -0.5, -0.5}, Losses{-1, -1, -1, -1});
    EXPECT_EQ(noise.verdict, Verdict::kUndecided);
    EXPECT_TRUE(std::isnan(noise.ratio.ratio));
    EXPECT_TRUE(std::isnan(noise.spread_percent));
}

// Without a step all runs have the loss of the start, as the seed of their pair evaluates it.
TEST(Adam, LossesAreWithoutNoise) {
    ReproduceOptions options = test::small_options();
    options.sweep_seconds = 0;
    std::vector<TargetScene> scenes;
    scenes.push_back(test::small_target_scene(options));
    const ExperimentResult result = run_adam(scenes, options, {[](const std::string&) {}, {}});
    test::expect_unique_rows(result);
    std::vector<double> losses;
    for (const Measurement& m : result.measurements)
        if (m.metric == "loss") losses.push_back(m.value);
    ASSERT_EQ(losses.size(), 27u);
    for (std::uint32_t pair = 0; pair < 9; ++pair) {
        Options run = paper_options(scenes[0], options);
        run.seed = options.seed + pair;
        const Solver start(problem_of(scenes[0]), run);
        const double loss = loss_without_noise(start.evaluate(options.evaluation_samples, 1));
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_NEAR(losses[3 * pair + k] / loss, 1, 1e-9) << "pair " << pair;
    }
    const Figure& f = result.figures.at(0);
    EXPECT_EQ(f.verdict, Verdict::kUndecided);
    EXPECT_NE(f.measured.find("below mc in 0 of 9 pairs with replay and in 0 with the identity"),
              std::string::npos)
        << f.measured;
}

constexpr std::uint32_t kFrozen = 32;  // iterations, of which the later half counts

/// With e the gradients less the reference, at frozen textures: means over iterations.
struct ErrorProducts {
    double square = 0, square_before = 0, product = 0;  ///< of e_v, e_(v - 1), both
};

ErrorProducts products_of(const TargetScene& scene, const Estimator& estimator,
                          std::uint32_t seed) {
    const Study& study = *scene.study;
    ScriptedEstimator along(estimator, seed);
    ErrorProducts mean;
    Image before;
    for (std::uint32_t v = 0; v < kFrozen; ++v) {
        Image error = estimate_next(scene.traced(), study.trajectory.theta.back(),
                                    study.trajectory.adjoint.back(), v, along);
        for (std::size_t i = 0; i < error.values.size(); ++i)
            error.values[i] -= study.reference.gradient.values[i];
        if (v >= kFrozen / 2) {
            mean.square += dot(error, error) / (kFrozen / 2);
            mean.square_before += dot(before, before) / (kFrozen / 2);
            mean.product += dot(error, before) / (kFrozen / 2);
        }
        before = error;
    }
    return mean;
}

/// Measurements by metric and variant, of losses without a step.
std::map<std::string, double> measured_by_adam(const TargetScene& scene, ReproduceOptions options,
                                               double squared_error) {
    options.sweep_seconds = 0;
    std::vector<TargetScene> scenes;
    scenes.push_back(test::small_target_scene(options));
    auto study = std::make_shared<Study>(*scene.study);
    study->reference.squared_error = squared_error;
    scenes[0].study = study;
    std::map<std::string, double> values;
    for (const Measurement& m :
         run_adam(scenes, options, {[](const std::string&) {}, {}}).measurements)
        values[m.metric + " of " + m.variant] = m.value;
    return values;
}

// The reference's own error is a part of each, and correlates them.
TEST(Adam, ErrorsAreWithoutTheNoiseOfTheReference) {
    const ReproduceOptions options = test::small_options();
    TargetScene scene = test::small_target_scene(options);
    scene.study = make_study(scene, options, {[](const std::string&) {}, {}});
    const Image& reference = scene.study->reference.gradient;
    const ErrorProducts mc =
        products_of(scene, baseline_estimator(options), estimate_seed(options));
    const std::string moment = "nmse_of_first_moment of mc, beta1 0.9",
                      lag = "error_correlation of mc, lag 1";
    const auto whole = measured_by_adam(scene, options, 0);
    const double power = dot(reference, reference), sum = power * whole.at(moment),
                 s = 0.3 * std::min({power, sum, mc.square, mc.square_before});
    const auto own = measured_by_adam(scene, options, s);
    EXPECT_NEAR(own.at(moment), (sum - s) / (power - s), 1e-9 * own.at(moment));
    EXPECT_NEAR(whole.at(lag), mc.product / std::sqrt(mc.square * mc.square_before), 1e-9);
    EXPECT_NEAR(own.at(lag), (mc.product - s) / std::sqrt((mc.square - s) * (mc.square_before - s)),
                1e-9);
    EXPECT_GT(whole.at(lag) - own.at(lag), 1e-6);
    EXPECT_NEAR(own.at("error_correlation of mc, lag 0"), 1, 1e-9);
}

TEST(Adam, ErrorsThatTheReferenceHidesTellNothing) {
    ReproduceOptions options = test::small_options();
    options.sweep_seconds = 0.004;
    std::vector<TargetScene> scenes;
    scenes.push_back(test::small_target_scene(options));
    scenes[0].study = test::study_of_noise(scenes[0], options);
    const ExperimentResult result = run_adam(scenes, options, {[](const std::string&) {}, {}});
    const Figure& decay = result.figures.at(0);
    EXPECT_TRUE(decay.measured.starts_with("After 0.004 s each the loss")) << decay.measured;
    const Figure& f = result.figures.at(1);
    EXPECT_NE(f.measured.find("reference is too noisy to tell"), std::string::npos) << f.measured;
    for (const auto& row : f.tables.at(0).rows)
        for (std::size_t k = 1; k < row.size(); ++k) EXPECT_EQ(row[k], "too noisy to tell");
}

}  // namespace
}  // namespace burnish
