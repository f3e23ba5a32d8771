// The decay rates of Adam: what losses tell, and of what they are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "experiments/decay_rates.h"
#include "experiments/experiments.h"
#include "experiments/small_target_scene.h"

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
    EXPECT_EQ(compare_decay(Losses{2, 2, 2, 2}, mc).verdict, Verdict::kPartly) << "narrow";
    EXPECT_EQ(compare_decay(Losses{2, 3, 2, 3}, mc).verdict, Verdict::kFails);
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

}  // namespace
}  // namespace burnish
