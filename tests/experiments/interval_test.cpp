// Intervals of ratios, by hand, and the verdicts that they give.
#include "experiments/interval.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace burnish {
namespace {

TEST(RatioInterval, IsStudentsOfTheLogarithms) {
    // Logarithms -2, 0, 2 around 0.3: standard deviation 2, 4.303 standard errors to either side.
    const std::vector<double> ratios{std::exp(-1.7), std::exp(0.3), std::exp(2.3)};
    const RatioInterval i = ratio_interval(ratios);
    EXPECT_NEAR(i.ratio, std::exp(0.3), 1e-12);
    EXPECT_NEAR(std::log(i.high), 0.3 + 4.303 * 2 / std::sqrt(3.0), 1e-12);
    EXPECT_NEAR(std::log(i.low), 0.3 - 4.303 * 2 / std::sqrt(3.0), 1e-12);
}

/// scipy.stats.t.ppf(0.975, n - 1)
TEST(RatioInterval, OfManyRunsHasStudentsPercentile) {
    for (const auto& [count, percentile] : {std::pair{5, 2.776445},
                                            {11, 2.228139},
                                            {18, 2.109816},
                                            {31, 2.042272},
                                            {101, 1.983972}}) {
        std::vector<double> ratios;
        double squares = 0;
        for (int k = 0; k < count; ++k) {
            const double x = k - 0.5 * (count - 1);
            ratios.push_back(std::exp(x / count));
            squares += x * x / count / count;
        }
        const double error = std::sqrt(squares / (count - 1) / count);
        EXPECT_NEAR(std::log(ratio_interval(ratios).high) / error, percentile, 2e-3) << count;
    }
}

TEST(RatioInterval, OfOneRunOrOfNoiseTellsNothing) {
    const RatioInterval one = ratio_interval(std::vector{0.5});
    EXPECT_EQ(one.ratio, 0.5);
    EXPECT_EQ(text_of(one), "0.50");
    EXPECT_EQ(verdict_below_one(one), Verdict::kUndecided);
    const RatioInterval noise = ratio_interval(std::vector{0.5, -0.1, 0.4});
    EXPECT_EQ(text_of(noise), "too noisy to tell");
    EXPECT_EQ(verdict_below_one(noise), Verdict::kUndecided);
}

TEST(RatioInterval, DecidesWhereAllOfItLiesOnOneSide) {
    EXPECT_EQ(verdict_below_one({0.6, 0.5, 0.9}), Verdict::kHolds);
    EXPECT_EQ(verdict_below_one({0.6, 0.5, 1.1}), Verdict::kUndecided);
    EXPECT_EQ(verdict_below_one({1.6, 1.1, 1.9}), Verdict::kFails);
    EXPECT_EQ(text_of({0.6, 0.5, 0.9}), "0.60 [0.50, 0.90]");
}

TEST(RatioInterval, OfTwoWaysHoldsInPartWhereTheSecondAloneDoes) {
    const RatioInterval below{0.6, 0.5, 0.9}, around{0.6, 0.5, 1.1}, above{1.6, 1.1, 1.9};
    EXPECT_EQ(verdict_below_one(below, above), Verdict::kHolds);
    EXPECT_EQ(verdict_below_one(above, below), Verdict::kPartly);
    EXPECT_EQ(verdict_below_one(around, below), Verdict::kPartly);
    EXPECT_EQ(verdict_below_one(around, above), Verdict::kUndecided);
    EXPECT_EQ(verdict_below_one(above, around), Verdict::kFails);
}

TEST(RatioInterval, OfLossesNeedsBothAboveZero) {
    EXPECT_EQ(positive_ratio(1, 4), 0.25);
    EXPECT_EQ(nmse_text(0.12345), "0.123");
    for (const double error : {double{NAN}, double{INFINITY}})
        EXPECT_EQ(nmse_text(error), "too noisy to tell");
    for (const auto& [a, b] : {std::pair{-1.0, -4.0}, {-1.0, 4.0}, {1.0, -4.0}, {0.0, 4.0}})
        EXPECT_TRUE(std::isnan(positive_ratio(a, b))) << a << " " << b;
    const std::vector<double> ratios{0.5, positive_ratio(-1, -4), 0.4};
    EXPECT_EQ(verdict_below_one(ratio_interval(ratios)), Verdict::kUndecided);
}

TEST(RatioInterval, OfErrorsIsSaidAsAMultiple) {
    EXPECT_EQ(multiple_text(1, 4, "that"), "0.25 times that");
    EXPECT_EQ(multiple_text(-1, 4, "that"), "an error too noisy to tell");
}

TEST(RatioInterval, OfAPartIsSaidInPercent) {
    for (const auto& [share, text] : {std::pair{1.0, "100 %"},
                                      {1.234, "123 %"},
                                      {0.996, "100 %"},
                                      {0.123, "12 %"},
                                      {0.0996, "10 %"},
                                      {0.0251, "2.5 %"},
                                      {0.00034, "0.034 %"},
                                      {0.0, "0 %"},
                                      {double{NAN}, "too noisy to tell"}})
        EXPECT_EQ(share_text(share), text) << share;
}

TEST(RatioInterval, IsSaidOfRuns) {
    EXPECT_EQ(interval_text(5), "with 95 % intervals over 5 runs");
    EXPECT_EQ(interval_text(1), "one run, no interval");
}

TEST(RatioInterval, OfASingleRunStandsWhereItsRatioDoes) {
    const auto sides = [](const RatioInterval& i) {
        return std::pair{stands_below_one(i), stands_above_one(i)};
    };
    EXPECT_EQ(sides({0.8, 0.7, 0.9}), std::pair(true, false));
    EXPECT_EQ(sides({0.8, 0.6, 1.1}), std::pair(false, false));
    EXPECT_EQ(sides({1.2, 0.9, 1.6}), std::pair(false, false));
    EXPECT_EQ(sides({1.2, 1.1, 1.3}), std::pair(false, true));
    EXPECT_EQ(sides(ratio_interval(std::vector{0.8})), std::pair(true, false));
    EXPECT_EQ(sides(ratio_interval(std::vector{1.2})), std::pair(false, true));
    EXPECT_EQ(sides(ratio_interval(std::vector{-1.0})), std::pair(false, false));
}

TEST(Verdicts, OfUpperBoundsNeverFail) {
    EXPECT_EQ(bounds_below_one({0.6, 0.5, 0.9}), Verdict::kHolds);
    EXPECT_EQ(bounds_below_one({1, 0.9, 1.1}), Verdict::kUndecided);
    EXPECT_EQ(bounds_below_one({1.6, 1.1, 1.9}), Verdict::kUndecided);
}

TEST(Verdicts, OfTwoWaysAreThoseOfTheFirstUnlessTheSecondDoesBetter) {
    using enum Verdict;
    EXPECT_EQ(verdict_of_ways(kHolds, kFails), kHolds);
    EXPECT_EQ(verdict_of_ways(kFails, kHolds), kPartly);
    EXPECT_EQ(verdict_of_ways(kUndecided, kPartly), kPartly);
    EXPECT_EQ(verdict_of_ways(kUndecided, kFails), kUndecided);
    EXPECT_EQ(verdict_of_ways(kFails, kUndecided), kFails);
}

TEST(Verdicts, OfTwoPartsHoldWhereBothDo) {
    using enum Verdict;
    EXPECT_EQ(verdict_of_parts(kHolds, kHolds), kHolds);
    EXPECT_EQ(verdict_of_parts(kHolds, kFails), kPartly);
    EXPECT_EQ(verdict_of_parts(kUndecided, kHolds), kPartly);
    EXPECT_EQ(verdict_of_parts(kUndecided, kFails), kFails);
    EXPECT_EQ(verdict_of_parts(kFails, kFails), kFails);
    EXPECT_EQ(verdict_of_parts(kUndecided, kUndecided), kUndecided);
}

/// ris keeps a floor of variance, pris has none.
TEST(Verdicts, AFloorOfVarianceIsDecidedByWhatBothLose) {
    const RatioInterval stays{1.0, 0.98, 1.02}, falls{8.1, 7.8, 8.3}, unclear{2, 0.9, 9};
    EXPECT_EQ(floor_verdict(stays, falls), Verdict::kHolds);
    EXPECT_EQ(floor_verdict(falls, stays), Verdict::kFails);
    EXPECT_EQ(floor_verdict(stays, stays), Verdict::kPartly);
    EXPECT_EQ(floor_verdict(unclear, unclear), Verdict::kUndecided);
}

}  // namespace
}  // namespace burnish
