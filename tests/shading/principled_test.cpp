// `principled` against the reference table.
//
// The table was made in single precision and printed with seven digits, so no evaluation can agree
// better than the problem is conditioned. The allowed difference of an output is therefore
//
//   1e-4 (value) or 1e-3 (derivative) of the row's largest of its kind
//     + how far our own double evaluation moves when the inputs move by the printed half unit and
//     two float ulps
//     + how far the clearcoat moves when 1 + (a^2 - 1) cos^2, in single precision, is off by four
//     half ulps of 1.
//
// No row is exempt, and nothing in the bound depends on which rows there are.
#include "principled_table.h"
#include "shading/printed_step.h"
#include "worst.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace burnish::test {
namespace {

double largest(const PrincipledOutputs& out, std::size_t from, std::size_t to) {
    double m = 0;
    for (std::size_t q = from; q < to; ++q) m = std::max(m, std::abs(out[q]));
    return m;
}

/// Difference of each output over what is allowed; the largest of them. +inf where an output is not
/// finite.
double worst_ratio(const PrincipledOutputs& ours, const PrincipledOutputs& reference,
                   double value_tolerance, double derivative_tolerance,
                   const PrincipledOutputs& spread) {
    const double value = value_tolerance * largest(reference, 0, 3);
    const double derivative = derivative_tolerance * largest(reference, 3, kOutputs);
    double worst = 0;
    for (std::size_t q = 0; q < kOutputs; ++q) {
        const double difference = std::abs(ours[q] - reference[q]);
        if (!std::isfinite(difference)) return HUGE_VAL;
        // 1e-30: below the normal numbers of single precision.
        worst = test::worse(worst, difference / ((q < 3 ? value : derivative) + spread[q] + 1e-30));
    }
    return worst;
}

PrincipledOutputs allowed_spread(const PrincipledInputs& in, int group) {
    PrincipledOutputs spread = spread_of_inputs(in, group, printed_step);
    const PrincipledOutputs coat = spread_of_clearcoat(in, group, 8 * kHalfUlp);
    for (std::size_t q = 0; q < kOutputs; ++q) spread[q] += coat[q];
    return spread;
}

/// Rows whose difference is not allowed, when ours is evaluated at changed inputs.
std::size_t rows_outside(const std::function<void(PrincipledInputs&)>& change, bool report) {
    std::size_t outside = 0;
    for (const CsvRow& row : reference_table("principled.csv")) {
        const int group = static_cast<int>(row["group"]);
        const PrincipledInputs in = inputs_of_row(row);
        PrincipledInputs changed = in;
        change(changed);
        const double ratio = worst_ratio(evaluate<double>(changed, group), outputs_of_row(row),
                                         1e-4, 1e-3, allowed_spread(in, group));
        if (ratio <= 1) continue;
        ++outside;
        if (report)
            ADD_FAILURE() << "line " << row.line << ": difference is " << ratio
                          << " of what is allowed";
    }
    return outside;
}

TEST(Principled, AgreesWithTheTable) {
    EXPECT_EQ(rows_outside([](PrincipledInputs&) {}, true), 0u);
}

TEST(Principled, TheTableRejectsDefects) {
    EXPECT_GT(rows_outside([](PrincipledInputs& in) { in[3] *= 1.003; }, false), 100u)
        << "roughness";
    EXPECT_GT(rows_outside([](PrincipledInputs& in) { in[19] *= 1.001; }, false), 100u) << "eta";
    EXPECT_GT(
        rows_outside(
            [](PrincipledInputs& in) { std::swap(in[13], in[14]), std::swap(in[16], in[17]); },
            false),
        100u)
        << "alpha_x and alpha_y swapped";
    EXPECT_GT(rows_outside([](PrincipledInputs& in) { std::swap(in[8], in[9]); }, false), 100u)
        << "sheen and sheen_tint swapped";
    EXPECT_GT(rows_outside([](PrincipledInputs& in) { in[12] += 0.002; }, false), 100u)
        << "clearcoat_gloss";
}

/// Half of the rows agree far better than what is allowed in general, so the bound above does not
/// hide a small error.
TEST(Principled, MedianAgreementIsSinglePrecision) {
    std::vector<double> ratios;
    for (const CsvRow& row : reference_table("principled.csv")) {
        const PrincipledOutputs ours =
            evaluate<double>(inputs_of_row(row), static_cast<int>(row["group"]));
        ratios.push_back(worst_ratio(ours, outputs_of_row(row), 1, 1, {}));
    }
    std::nth_element(ratios.begin(), ratios.begin() + static_cast<long>(ratios.size() / 2),
                     ratios.end());
    EXPECT_LT(ratios[ratios.size() / 2], 1e-6);
}

/// Float against double on the same inputs: 2e-5 of the row's largest, and the inputs moved by two
/// ulps.
TEST(Principled, FloatAgreesWithDouble) {
    for (const CsvRow& row : reference_table("principled.csv")) {
        const int group = static_cast<int>(row["group"]);
        PrincipledInputs in = inputs_of_row(row);
        for (double& x : in) x = static_cast<double>(static_cast<float>(x));
        const PrincipledOutputs spread =
            spread_of_inputs(in, group, [](double x) { return 4 * kHalfUlp * std::abs(x); });
        EXPECT_LE(worst_ratio(evaluate<float>(in, group), evaluate<double>(in, group), 2e-5, 2e-5,
                              spread),
                  1)
            << "line " << row.line;
    }
}

/// A flag that is set without need changes nothing.
TEST(Principled, FlagsOnlySkipWork) {
    for (const CsvRow& row : reference_table("principled.csv")) {
        const int group = static_cast<int>(row["group"]);
        const PrincipledInputs in = inputs_of_row(row);
        auto p = dual_parameters<double>(in, group);
        p.has_anisotropic = p.has_spec_trans = p.has_spec_tint = p.has_sheen = p.has_flatness =
            p.has_clearcoat = true;
        const auto f =
            eval_principled(p, direction_at<double>(in, 13), direction_at<double>(in, 16));
        const PrincipledOutputs all = outputs_of<double>(f, group),
                                few = evaluate<double>(in, group);
        for (std::size_t q = 0; q < kOutputs; ++q)
            EXPECT_NEAR(all[q], few[q], 1e-12 * std::abs(few[q]))
                << "line " << row.line << " output " << q;
    }
}

}  // namespace
}  // namespace burnish::test
