// What the baseline needs for the error of pgris: runs with seeds of their own, and what they
// decide.
#include "experiments/equal_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "experiments/experiments.h"
#include "experiments/small_target_scene.h"
#include "experiments/unique_rows.h"

namespace burnish {
namespace {

ExperimentResult result_of(const ReproduceOptions& options) {
    std::vector<TargetScene> scenes;
    scenes.push_back(test::small_target_scene(options));
    return run_equal_error(scenes, options, {[](const std::string&) {}, {}});
}

/// Of a variant, or of each of its runs.
std::vector<double> values_of(const ExperimentResult& result, const std::string& variant,
                              const std::string& metric) {
    std::vector<double> values;
    for (const Measurement& m : result.measurements)
        if ((m.variant == variant || m.variant.starts_with(variant + ", run ")) &&
            m.metric == metric)
            values.push_back(m.value);
    return values;
}

bool says(const Figure& f, const std::string& text) {
    return f.measured.find(text) != std::string::npos;
}

TEST(EqualError, ItsVerdictIsThatOfTheIntervalOverRuns) {
    const ExperimentResult result = result_of(test::small_options());
    test::expect_unique_rows(result);
    const Figure& f = result.figures.at(0);
    std::vector<RatioInterval> intervals;
    for (const char* variant : {"pgris, replay", "pgris, identity"}) {
        const auto nmse = values_of(result, variant, "nmse");
        ASSERT_EQ(nmse.size(), 3u) << variant;
        EXPECT_NE(nmse[0], nmse[1]) << variant;
        const auto seconds = values_of(result, variant, "derivative_seconds"),
                   of_mc = values_of(result, variant, "mc_seconds");
        ASSERT_EQ(of_mc.size(), 3u) << variant << ": mc reaches the error within 64 samples";
        std::vector<double> ratios;
        for (std::size_t k = 0; k < 3; ++k) ratios.push_back(seconds[k] / of_mc[k]);
        intervals.push_back(ratio_interval(ratios));
        EXPECT_LT(intervals.back().high, INFINITY) << variant;
        EXPECT_EQ(values_of(result, variant, "seconds_over_those_of_mc_high"),
                  std::vector{intervals.back().high});
        EXPECT_TRUE(says(f, text_of(intervals.back()))) << f.measured;
    }
    EXPECT_EQ(f.verdict, verdict_below_one(intervals[0], intervals[1]));
    EXPECT_TRUE(f.claim.ends_with("the same error takes less time.")) << f.claim;
    EXPECT_TRUE(says(f, interval_text(3))) << f.measured;
}

/// Three runs of pgris with so many seconds about, beside 1 s of mc.
std::vector<EqualErrorRun> three_runs(double seconds, bool last_is_bound) {
    std::vector<EqualErrorRun> runs;
    for (const double factor : {0.9, 1.0, 1.1}) runs.push_back({0.1, seconds * factor, {8, 1}});
    runs.back().mc.is_bound = last_is_bound;
    return runs;
}

TEST(EqualError, BoundsNeverTellAgainstPgris) {
    EXPECT_EQ(verdict_of(three_runs(0.5, false)), Verdict::kHolds);
    EXPECT_EQ(verdict_of(three_runs(1, false)), Verdict::kUndecided);
    EXPECT_EQ(verdict_of(three_runs(2, false)), Verdict::kFails);
    EXPECT_EQ(verdict_of(three_runs(0.5, true)), Verdict::kHolds);
    EXPECT_EQ(verdict_of(three_runs(1, true)), Verdict::kUndecided);
    EXPECT_EQ(verdict_of(three_runs(2, true)), Verdict::kUndecided);
}

TEST(EqualError, WhatFallsShortHasAReason) {
    const auto reason = [](double seconds, bool last_is_bound, Verdict of_figure) {
        return equal_error_reason(three_runs(seconds, last_is_bound), of_figure);
    };
    EXPECT_EQ(reason(0.5, false, Verdict::kHolds), "");
    EXPECT_EQ(reason(1, false, Verdict::kUndecided), "");
    EXPECT_EQ(reason(2, true, Verdict::kUndecided), "");
    EXPECT_EQ(reason(2, false, Verdict::kFails),
              "mc needs more samples for the error of replay, but on a CPU they cost less than "
              "shifting the history: 1 s in place of 1.99 s.");
    std::vector<EqualErrorRun> at_one_sample = three_runs(2, false);
    for (EqualErrorRun& run : at_one_sample) run.mc.samples = 1;
    EXPECT_TRUE(
        equal_error_reason(at_one_sample, Verdict::kFails).ends_with("1.99 times its seconds."));
    // The claim holds of the other shift.
    EXPECT_TRUE(reason(1, false, Verdict::kPartly).starts_with("The interval of replay holds 1"));
    EXPECT_TRUE(reason(1, true, Verdict::kPartly).starts_with("The error of replay is out of"));
    std::vector<EqualErrorRun> hidden = three_runs(1, false);
    hidden[0].mc = {NAN, NAN};
    EXPECT_TRUE(equal_error_reason(hidden, Verdict::kPartly).starts_with("The noise of the"));
}

TEST(EqualError, OneRunDecidesNothing) {
    ReproduceOptions options = test::small_options();
    options.runs = 1;
    const ExperimentResult result = result_of(options);
    const Figure& f = result.figures.at(0);
    EXPECT_EQ(f.verdict, Verdict::kUndecided);
    EXPECT_TRUE(says(f, "one run, no interval")) << f.measured;
    // Its ratio is explained where it is against the claim.
    const auto ratio = values_of(result, "pgris, replay", "seconds_over_those_of_mc");
    const bool is_slower = !ratio.empty() && ratio[0] > 1;
    EXPECT_EQ(f.why.empty(), !is_slower) << f.measured << f.why;
}

TEST(EqualError, AnErrorThatMcDoesNotReachIsABound) {
    ReproduceOptions options = test::small_options();
    options.max_samples = 1;
    const ExperimentResult result = result_of(options);
    const Figure& f = result.figures.at(0);
    EXPECT_FALSE(values_of(result, "pgris, replay", "mc_seconds_at_least").empty());
    EXPECT_TRUE(says(f, "with replay at least 1.00")) << f.measured;
    EXPECT_TRUE(says(f, "pgris at most ")) << f.measured;
    EXPECT_NE(f.verdict, Verdict::kFails);
}

TEST(EqualError, ErrorsThatTheReferenceHidesTellNothing) {
    ReproduceOptions options = test::small_options();
    options.runs = 2;
    std::vector<TargetScene> scenes;
    scenes.push_back(test::small_target_scene(options));
    scenes[0].study = test::study_of_noise(scenes[0], options);
    const ExperimentResult result =
        run_equal_error(scenes, options, {[](const std::string&) {}, {}});
    const Figure& f = result.figures.at(0);
    EXPECT_EQ(f.verdict, Verdict::kUndecided);
    EXPECT_TRUE(says(f, "with replay too noisy to tell; with")) << f.measured;
    for (const auto& row : f.tables.at(0).rows)
        for (const std::string& cell : row) EXPECT_NE(cell, "nan") << row[0];
    for (const char* metric : {"nmse", "mc_samples_per_pixel", "mc_seconds"}) {
        const auto values = values_of(result, "pgris, replay", metric);
        ASSERT_EQ(values.size(), 2u) << metric;
        EXPECT_TRUE(std::isnan(values[0])) << metric;
    }
}

}  // namespace
}  // namespace burnish
