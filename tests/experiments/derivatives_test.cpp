// What `derivatives` says of one run, and why its claim does not hold.
#include "experiments/derivatives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "experiments/experiments.h"
#include "experiments/small_target_scene.h"
#include "experiments/unique_rows.h"

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
    EXPECT_EQ(f.measured.find("about the same time"), std::string::npos) << f.measured;
    EXPECT_NE(f.measured.find(" spp, which takes "), std::string::npos) << f.measured;
    EXPECT_NE(f.measured.find("with the product of error and time as the measure: that of the path "
                              "cache"),
              std::string::npos)
        << f.measured;
}

/// Two runs on the scene under this name.
ExperimentResult result_under(const std::string& name) {
    ReproduceOptions options = test::small_options();
    options.runs = 2;
    std::vector<TargetScene> scenes;
    scenes.push_back(test::small_target_scene(options));
    scenes[0].source.name = name;
    return run_derivatives(scenes, options, {[](const std::string&) {}, {}});
}

TEST(Derivatives, TheClaimIsOfMoreOfTheTree) {
    for (const auto& [name, claim] :
         {std::pair{"goblet", "lower than with detached sampling."},
          {"tree", "over four times lower than with detached sampling."}})
        EXPECT_EQ(result_under(name).figures.at(0).claim,
                  std::string("At equal time the error of the derivatives is ") + claim);
}

// Samples of mc in the time of one shift may be as many as in that of the other.
TEST(Derivatives, RowsTellTheirRunAndTheirVariant) {
    const ExperimentResult result = result_under("goblet");
    test::expect_unique_rows(result);
    for (const std::string run : {", run 0", ", run 1"})
        for (const std::string shift : {"replay", "identity"})
            EXPECT_EQ(std::ranges::count_if(result.measurements,
                                            [&](const Measurement& m) {
                                                return m.metric == "nmse" &&
                                                       m.variant.ends_with("the time of pgris, " +
                                                                           shift + run);
                                            }),
                      1)
                << shift << run;
}

TEST(Derivatives, TheVerdictIsOfTheClaim) {
    const RatioInterval half{0.5, 0.4, 0.6}, fifth{0.2, 0.15, 0.24}, around{0.25, 0.2, 0.3};
    EXPECT_EQ(derivatives_verdict(half, half, 1), Verdict::kHolds);
    EXPECT_EQ(derivatives_verdict(half, half, 0.25), Verdict::kFails);
    EXPECT_EQ(derivatives_verdict(fifth, fifth, 0.25), Verdict::kHolds);
    EXPECT_EQ(derivatives_verdict(half, fifth, 0.25), Verdict::kPartly);
    EXPECT_EQ(derivatives_verdict(around, around, 0.25), Verdict::kUndecided);
}

TEST(Derivatives, TheReasonIsWhatReplayTakesUnlessItsIntervalDoesNotTell) {
    const RatioInterval below{0.5, 0.4, 0.6}, around{1, 0.9, 1.1}, above{2, 1.5, 2.5},
        single{.ratio = 2}, noise{.ratio = NAN};
    const auto reason = [](const RatioInterval& replay, Verdict of_figure) {
        return derivatives_reason(replay, 1, of_figure, 0.0125, 3);
    };
    const std::string costs = reason(above, Verdict::kFails);
    EXPECT_TRUE(
        costs.ends_with("mc takes 0.0125 s for 1 sample per pixel, and pgris, which replays "
                        "its history beside one fresh sample, takes about as long as 3 of "
                        "mc."))
        << costs;
    EXPECT_EQ(reason(above, Verdict::kPartly), costs);
    EXPECT_EQ(reason(around, Verdict::kPartly),
              "The interval of replay holds 1: more runs would decide.");
    EXPECT_EQ(reason(single, Verdict::kUndecided), costs);
    EXPECT_EQ(reason(noise, Verdict::kPartly),
              "The noise of the converged derivative hides what replay does.");
    EXPECT_EQ(reason(noise, Verdict::kUndecided), "");
    EXPECT_EQ(reason(below, Verdict::kHolds), "");
    EXPECT_EQ(reason(around, Verdict::kUndecided), "");
    // The claim may be of a quarter.
    EXPECT_EQ(derivatives_reason(below, 0.25, Verdict::kFails, 0.0125, 3), costs);
    EXPECT_EQ(derivatives_reason({0.25, 0.2, 0.3}, 0.25, Verdict::kPartly, 0.0125, 3),
              "The interval of replay holds 0.25: more runs would decide.");
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
    EXPECT_NE(f.measured.find("that of mc is too noisy to tell with the replay shift and too "
                              "noisy to tell with the identity shift"),
              std::string::npos)
        << f.measured;
    EXPECT_NE(f.measured.find(" s, is too noisy to tell."), std::string::npos) << f.measured;
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
