// The path cache in an optimisation run: its textures depend on the records that its gradient is
// made of. The bias that this leaves along the gradient, for single texels at the default learning
// rate, has a bound.
#include "experiments/closed_loop.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/parallel.h"
#include "ledger_entries.h"
#include "optimize/small_problem.h"
#include "student.h"

namespace burnish {
namespace {

using test::ledger::kClosedLoop;

/// The share of the gradient that may be lost or gained.
constexpr double kMaxBias = 0.25;

/// The roughness of the small scene, from 0.5, after a picture with little noise.
Problem make_problem() {
    Problem problem = test::problem_of(test::make_small_scene());
    problem.views[0].image = problem.renderer.render(1024, 65);
    problem.unknowns = {{problem.unknowns[1].name, 0.5f}};
    return problem;
}

using Products = std::vector<LoopProducts>;

Products measure(const Problem& problem, double learning_rate, std::uint32_t seeds) {
    constexpr std::uint32_t kIterations = 5;
    Options options;
    options.parameterization = Parameterization::kTexels;
    options.loss = Loss::kRelMse;
    options.learning_rate = learning_rate;
    Products runs(test::scaled(kClosedLoop, 400u));
    parallel_for(runs.size(), [&](std::size_t k) {
        const auto seed = test::seed_of(kClosedLoop, seeds + static_cast<std::uint32_t>(k));
        runs[k] = run_closed_loop(problem, options, kIterations, seed);
    });
    const LoopBias bias = bias_of(runs);
    fmt::print("learning rate {}: bias {:+.1f} +- {:.1f} %\n", learning_rate, 100 * bias.bias,
               100 * bias.standard_error);
    return runs;
}

/// p-value of "E<error> <= factor E<norm>", one-sided.
double at_most_p_value(const Products& runs, double factor, double sign) {
    test::RunningMean excess;
    for (const LoopProducts& p : runs) excess.add(sign * p.error - factor * p.norm);
    return test::not_above_p_value(test::estimate_of(excess), {});
}

/// p-value of "the bias is at most kMaxBias, up or down".
double p_value(const Products& runs) {
    return std::min(at_most_p_value(runs, kMaxBias, 1), at_most_p_value(runs, kMaxBias, -1));
}

// Where all norms are the same the bias is a mean, and its error that of one.
TEST(ClosedLoop, TheErrorOfABiasIsThatOfAMean) {
    const Products runs{{1, 2}, {3, 2}, {8, 2}};  // deviations -3, -1, 4; variance 26 / 2
    const LoopBias bias = bias_of(runs);
    EXPECT_DOUBLE_EQ(bias.bias, 2);
    EXPECT_DOUBLE_EQ(bias.standard_error, std::sqrt(13.0 / 3) / 2);
}

// The default is reweighted, by a path cache of 4 fresh passes and windows of 32.
TEST(ClosedLoop, GradientsOfReweightedPixelsAreComparedAtTheNoiseOfTheRun) {
    Options options;
    EXPECT_EQ(reference_passes(options, 1), 2u);
    EXPECT_EQ(reference_passes(options, 6), 12u);
    EXPECT_EQ(reference_passes(options, 25), 32u);
    options.estimator = PathCache{.samples = 1, .window = 16};
    EXPECT_EQ(reference_passes(options, 1), 1u);
    EXPECT_EQ(reference_passes(options, 25), 12u);
    options.loss = Loss::kRelMse;
    EXPECT_EQ(reference_passes(options, 1), 16u);
    EXPECT_EQ(reference_passes(options, 25), 16u);
}

TEST(ClosedLoop, BiasOfThePathCacheIsBoundedAtTheDefaultRate) {
    const Problem problem = make_problem();
    constexpr double rate = 0.01;  // the default from a start that is not searched
    EXPECT_TRUE(accepted(kClosedLoop, "default rate", p_value(measure(problem, rate, 0))));
    EXPECT_TRUE(rejected(kClosedLoop, "steps five times as long",
                         p_value(measure(problem, 5 * rate, 100000))));
}

}  // namespace
}  // namespace burnish
