// What `derivatives` says of one run.
#include <gtest/gtest.h>

#include <cmath>
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

TEST(Derivatives, ErrorsThatTheReferenceHidesTellNothing) {
    ReproduceOptions options = test::small_options();
    options.runs = 2;
    std::vector<TargetScene> scenes;
    scenes.push_back(test::small_target_scene(options));
    scenes[0].study = test::study_of_noise(scenes[0], options);
    const ExperimentResult result =
        run_derivatives(scenes, options, {[](const std::string&) {}, {}});
    const Figure& f = result.figures.at(0);
    EXPECT_EQ(f.verdict, Verdict::kUndecided);
    EXPECT_EQ(f.why, "");
    EXPECT_NE(f.measured.find("replay shift is too noisy to tell"), std::string::npos)
        << f.measured;
    for (const auto& row : f.tables.at(0).rows) EXPECT_EQ(row.at(2), "too noisy to tell") << row[0];
    EXPECT_EQ(f.pictures.at(0).at(0).caption, "NMSE too noisy to tell");
    for (const Measurement& m : result.measurements)
        EXPECT_EQ(std::isnan(m.value), m.metric == "nmse" || m.metric.ends_with("_path_cache") ||
                                           m.metric.ends_with("_replay") ||
                                           m.metric.ends_with("_identity"))
            << m.metric;
}

}  // namespace
}  // namespace burnish
