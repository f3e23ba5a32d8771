// The path cache in an optimisation run: its textures depend on the records that its gradient is
// made of. The bias that this leaves along the gradient, for single texels at the default learning
// rate, has a bound.
#include "experiments/closed_loop.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/parallel.h"
#include "experiments/small_target_scene.h"
#include "ledger_entries.h"
#include "student.h"

namespace burnish {
namespace {

using test::ledger::kClosedLoop;

/// The share of the gradient that may be lost or gained.
constexpr double kMaxBias = 0.35;

LoopBias measure(const TargetScene& scene, double learning_rate, std::uint32_t iterations,
                 std::uint32_t seeds) {
    Options options;
    options.parameterization = Parameterization::kTexels;
    options.learning_rate = learning_rate;
    std::vector<LoopProducts> runs(test::scaled(kClosedLoop, 128u));
    parallel_for(runs.size(), [&](std::size_t k) {
        runs[k] =
            run_closed_loop(scene, options, iterations,
                            test::seed_of(kClosedLoop, seeds + static_cast<std::uint32_t>(k)));
    });
    const LoopBias bias = bias_of(runs);
    fmt::print("learning rate {}, iteration {}: bias {:+.1f} +- {:.1f} %\n", learning_rate,
               iterations, 100 * bias.bias, 100 * bias.standard_error);
    return bias;
}

/// p-value of "the bias is at most kMaxBias".
double p_value(const LoopBias& bias) {
    const double t = (std::abs(bias.bias) - kMaxBias) / bias.standard_error;
    return 0.5 * std::erfc(t / std::sqrt(2.0));
}

TEST(ClosedLoop, BiasOfThePathCacheIsBoundedAtTheDefaultRate) {
    ReproduceOptions small = test::small_options();
    const TargetScene scene = test::small_target_scene(small);
    EXPECT_TRUE(accepted(kClosedLoop, "default rate",
                         p_value(measure(scene, Options{}.learning_rate, 8, 0))));
    EXPECT_TRUE(rejected(kClosedLoop, "steps five times as long",
                         p_value(measure(scene, 0.05, 8, 100000))));
}

}  // namespace
}  // namespace burnish
