// The bias of the path cache in a closed loop, at the default rate: bounded, and seen to grow with
// the rate.
#include "experiments/closed_loop.h"

#include <gtest/gtest.h>

#include <cmath>

#include "experiments/small_target_scene.h"
#include "ledger_entries.h"
#include "statistics.h"

namespace burnish {
namespace {

constexpr double kBound = 0.25;

/// p-value of "the bias is no further from 0 than kBound".
double bounded_p_value(const LoopBias& b) {
    const double z = (std::abs(b.bias) - kBound) / b.standard_error;
    return 0.5 * std::erfc(z / std::sqrt(2.0));
}

TEST(ClosedLoop, BiasOfThePathCacheAtTheDefaultRateIsSmall) {
    const test::LedgerEntry& entry = test::ledger::kClosedLoop;
    // Many samples for each texel: otherwise noise hides the bias.
    ReproduceOptions small = test::small_options();
    small.width = small.height = 32;
    small.texture_side = 16;
    const TargetScene scene = test::small_target_scene(small);
    const std::uint32_t runs = test::scaled(entry, 24u);
    const auto bias = [&](double rate, std::uint32_t iterations, std::uint32_t first_run) {
        Options options;
        options.parameterization = Parameterization::kTexels;
        options.learning_rate = rate;
        std::vector<LoopProducts> products;
        for (std::uint32_t k = 0; k < runs; ++k)
            products.push_back(
                run_closed_loop(scene, options, iterations, test::seed_of(entry, first_run + k)));
        return bias_of(products);
    };
    const double rate = Options{}.learning_rate;
    const LoopBias usual = bias(rate, 24, 0), fast = bias(5 * rate, 8, 10000);
    RecordProperty("bias", std::to_string(usual.bias));
    RecordProperty("standard_error", std::to_string(usual.standard_error));
    EXPECT_TRUE(test::accepted(entry, "bias at the default rate", bounded_p_value(usual)))
        << usual.bias << " +- " << usual.standard_error;
    EXPECT_TRUE(test::rejected(entry, "a learning rate five times larger", bounded_p_value(fast)))
        << fast.bias << " +- " << fast.standard_error;
}

}  // namespace
}  // namespace burnish
