// What `derivatives` says of one run.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "experiments/experiments.h"
#include "experiments/small_target_scene.h"

namespace burnish {
namespace {

TEST(Derivatives, ASingleRunThatIsBehindHasAReason) {
    ReproduceOptions options = test::small_options();
    options.runs = 1;
    std::vector<TargetScene> scenes;
    scenes.push_back(test::small_target_scene(options));
    const ExperimentResult result =
        run_derivatives(scenes, options, {[](const std::string&) {}, {}});
    const Figure& f = result.figures.at(0);
    EXPECT_EQ(f.verdict, Verdict::kUndecided);
    std::vector<double> ratios;
    for (const Measurement& m : result.measurements)
        if (m.metric == "nmse_ratio_equal_time_replay") ratios.push_back(m.value);
    ASSERT_EQ(ratios.size(), 1u);
    EXPECT_EQ(f.why.empty(), !(ratios[0] > 1)) << f.measured << f.why;
}

}  // namespace
}  // namespace burnish
