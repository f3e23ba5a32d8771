// The statistics that the tests rely on, against values known in closed form.
#include "statistics.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "ledger_entries.h"
#include "student.h"

namespace burnish::test {
namespace {

TEST(Statistics, ChiSquareMatchesClosedForms) {
    // Two degrees: exp(-x/2). One: erfc(sqrt(x/2)). Four: exp(-x/2) (1 + x/2).
    for (const double x : {0.01, 0.5, 1.0, 3.0, 10.0, 60.0, 300.0}) {
        EXPECT_NEAR(chi_square_p_value(x, 2) / std::exp(-x / 2), 1, 1e-10);
        EXPECT_NEAR(chi_square_p_value(x, 1) / std::erfc(std::sqrt(x / 2)), 1, 1e-10);
        EXPECT_NEAR(chi_square_p_value(x, 4) / (std::exp(-x / 2) * (1 + x / 2)), 1, 1e-10);
    }
    EXPECT_EQ(chi_square_p_value(0, 5), 1);
    // Many degrees, far in the tail: Wilson-Hilferty's normal approximation is good to a few
    // percent.
    const double k = 1000, x = 1150,
                 z = (std::cbrt(x / k) - 1 + 2 / (9 * k)) / std::sqrt(2 / (9 * k));
    EXPECT_NEAR(chi_square_p_value(x, k) / (normal_p_value(z) / 2), 1, 0.05);
}

TEST(Statistics, NormalIsTwoSided) {
    EXPECT_NEAR(normal_p_value(1.959963984540054), 0.05, 1e-12);
    EXPECT_NEAR(normal_p_value(-1.959963984540054), 0.05, 1e-12);
    EXPECT_EQ(mean_p_value(2, 0, 2), 1);
    EXPECT_EQ(mean_p_value(2, 0, 3), 0);
}

TEST(Statistics, FamiliesShareAlpha) {
    EXPECT_NEAR(holm_minimum({0.04, 0.01, 0.03}), 0.03, 1e-15);
    EXPECT_EQ(holm_minimum({}), 1);
}

/// So that a test fails, and a seeded defect whose numbers are not finite survives.
TEST(Statistics, OfWhatIsNotANumberIsNotANumber) {
    const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
    for (const double p :
         {holm_minimum({nan, 0.5}), holm_minimum({0.5, nan}), chi_square_p_value(nan, 3),
          normal_p_value(nan), mean_p_value(nan, 1, 0), mean_p_value(nan, 0, 0),
          mean_p_value(0, nan, 0), mean_p_value(0, infinity, 0), mean_p_value(infinity, 1, 0),
          student_p_value(nan, 3), goodness_of_fit_p_value({1, 5}, {nan, 6}),
          goodness_of_fit_p_value({nan, 5}, {5, 6}), welch_p_value({nan, 0}, {0, 1}),
          welch_p_value({nan, 0}, {0, 0}), welch_p_value({0, nan}, {0, 1}),
          welch_p_value({infinity, 1}, {0, 1}), not_above_p_value({nan, 1}, {0, 1}),
          not_above_p_value({0, 1}, {0, nan})})
        EXPECT_TRUE(std::isnan(p)) << p;
    RunningMean spoiled;
    for (const double x : {1.0, infinity, 2.0}) spoiled.add(x);
    EXPECT_TRUE(std::isnan(welch_p_value(estimate_of(spoiled), {0, 0})));
}

TEST(Statistics, RunningMeanIsTheMean) {
    RunningMean m;
    for (const double x : {1.0, 2.0, 3.0, 6.0}) m.add(x);
    EXPECT_NEAR(m.mean, 3, 1e-15);
    EXPECT_NEAR(m.variance(), 14.0 / 3, 1e-14);
    // Central moments: sum of cubes -8 - 1 + 0 + 27 = 18, of squares 14.
    EXPECT_NEAR(m.skewness(), (18.0 / 4) / std::pow(14.0 / 4, 1.5), 1e-14);
}

/// How many of `trials` means of 800 numbers, 0 or the square of an exponential one (skewness 11),
/// lie off their expectation with a p-value below 0.001.
double count_of_alarms(std::uint32_t trials, bool corrected) {
    double alarms = 0;
    for (std::uint32_t trial = 0; trial < trials; ++trial) {
        RunningMean m;
        for (std::uint32_t i = 0; i < 400; ++i) {
            const auto u = uniforms({seed_of(ledger::kSkewedMeans), Stream::kTest}, trial, i, 0);
            for (const std::size_t k : {0, 2}) {
                const double e = -std::log1p(-static_cast<double>(u[k + 1]));
                m.add(u[k] < 0.3f ? e * e : 0);
            }
        }
        MeanEstimate estimate = estimate_of(m);
        if (!corrected) estimate.skewness = 0;
        alarms += welch_p_value(estimate, {0.6, 0}) < 0.001;
    }
    return alarms;
}

/// p-value of "at most two in a thousand", twice what is stated: the correction is not exact.
double alarms_p_value(double alarms, double trials) {
    return alarms > 0 ? 1 - gamma_q(alarms, 0.002 * trials) : 1;
}

TEST(Statistics, MeansOfSkewedNumbersRaiseNoAlarm) {
    const LedgerEntry& entry = ledger::kSkewedMeans;
    const std::uint32_t trials = scaled(entry, 10000u);
    EXPECT_TRUE(
        accepted(entry, "corrected", alarms_p_value(count_of_alarms(trials, true), trials)));
    EXPECT_TRUE(rejected(entry, "t without its correction",
                         alarms_p_value(count_of_alarms(trials, false), trials)));
}

/// A fair die passes, a die loaded by 5 % on one face does not; an impossible face is
/// seen at once.
TEST(Statistics, GoodnessOfFitToldApart) {
    const LedgerEntry& entry = ledger::kGoodnessOfFit;
    std::vector<double> counts(6, 0.0);
    const std::uint32_t throws = scaled(entry, 60000u);
    for (std::uint32_t i = 0; i < throws; ++i)
        ++counts[static_cast<std::size_t>(uniforms({seed_of(entry), Stream::kTest}, i, 0, 0)[0] *
                                          6)];
    EXPECT_TRUE(accepted(entry, "fair",
                         goodness_of_fit_p_value(counts, std::vector<double>(6, throws / 6.0))));
    std::vector<double> loaded(6, throws * 0.99 / 6);
    loaded[2] = throws * 1.05 / 6;
    EXPECT_TRUE(rejected(entry, "a face loaded by 5 %", goodness_of_fit_p_value(counts, loaded)));
    EXPECT_EQ(goodness_of_fit_p_value({1, 5}, {0, 6}), 0);
}

}  // namespace
}  // namespace burnish::test
