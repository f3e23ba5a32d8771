// Tests of means with few batches, Student's and Welch's t, and of means of skewed numbers, Hall's
// correction of t. Two-sided p-values.
#pragma once

#include "statistics.h"

namespace burnish::test {

/// The continued fraction of the incomplete beta function [DLMF 8.17.22], by modified Lentz.
inline double beta_fraction(double a, double b, double x) {
    constexpr double kTiny = std::numeric_limits<double>::min();
    const auto safe = [](double v) { return std::abs(v) < kTiny ? kTiny : v; };
    double c = 1, d = 1 / safe(1 - (a + b) * x / (a + 1)), h = d;
    for (int m = 1; m < 10000; ++m) {
        const double m2 = 2.0 * m;
        const double even = m * (b - m) * x / ((a + m2 - 1) * (a + m2));
        d = 1 / safe(1 + even * d), c = safe(1 + even / c), h *= d * c;
        const double odd = -(a + m) * (a + b + m) * x / ((a + m2) * (a + m2 + 1));
        d = 1 / safe(1 + odd * d), c = safe(1 + odd / c), h *= d * c;
        if (std::abs(d * c - 1) < 1e-15) break;
    }
    return h;
}

/// The regularised incomplete beta function I_x(a, b), x in [0, 1].
inline double incomplete_beta(double a, double b, double x) {
    if (std::isnan(x)) return x;
    if (!(x > 0)) return 0;
    if (!(x < 1)) return 1;
    const double front = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
                                  a * std::log(x) + b * std::log1p(-x));
    if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(a, b, x) / a;
    return 1 - front * beta_fraction(b, a, 1 - x) / b;
}

/// P(|T| >= |t|) for T of Student's distribution with `degrees` > 0 degrees of freedom.
inline double student_p_value(double t, double degrees) {
    return incomplete_beta(0.5 * degrees, 0.5, degrees / (degrees + t * t));
}

/// A mean with its standard error, the degrees of freedom behind the error, and the skewness of the
/// mean (that of one number over the square root of their count).
struct MeanEstimate {
    double mean = 0, standard_error = 0, degrees = std::numeric_limits<double>::infinity(),
           skewness = 0;
};

/// So many numbers tell the skewness well enough to correct for it: that of fewer is mostly noise.
inline constexpr double kEnoughForSkewness = 200;

inline MeanEstimate estimate_of(const RunningMean& m) {
    const double skewness = m.count < kEnoughForSkewness ? 0 : m.skewness() / std::sqrt(m.count);
    return {m.mean, m.standard_error(), m.count - 1, skewness};
}

/// t of a difference of means with this skewness, made symmetric [Hall 1992, "On the removal of
/// skewness by transformation"]. Where few large numbers make up a mean, their lack lowers the mean
/// and its standard error at once: of numbers with skewness 11, |t| > 4 is seen twenty times as
/// often in means of 800 as the normal distribution has it.
inline double without_skewness(double t, double skewness) {
    return t + skewness * (t * t / 3 + 1.0 / 6) + skewness * skewness * t * t * t / 27;
}

/// "Both means are equal" [Welch 1947, corrected for skewness]. Where neither varies, 1 if they are
/// equal and 0 if not; not a number where a mean or an error is not finite.
inline double welch_p_value(const MeanEstimate& a, const MeanEstimate& b) {
    const double va = a.standard_error * a.standard_error, vb = b.standard_error * b.standard_error,
                 v = va + vb;
    if (!std::isfinite(v) || !std::isfinite(a.mean - b.mean))
        return std::numeric_limits<double>::quiet_NaN();
    if (!(v > 0)) return a.mean == b.mean ? 1 : 0;
    const double degrees = v * v / (va * va / a.degrees + vb * vb / b.degrees);
    const double skewness =
        (a.skewness * va * a.standard_error - b.skewness * vb * b.standard_error) /
        (v * std::sqrt(v));
    const double t = without_skewness((a.mean - b.mean) / std::sqrt(v), skewness);
    return std::isfinite(degrees) ? student_p_value(t, degrees) : normal_p_value(t);
}

/// One-sided: "the mean of a is at most that of b".
inline double not_above_p_value(const MeanEstimate& a, const MeanEstimate& b) {
    const double p = welch_p_value(a, b);
    return a.mean > b.mean ? p / 2 : 1 - p / 2;
}

/// Of the numbers times a factor above 0.
inline MeanEstimate scaled_by(const MeanEstimate& m, double factor) {
    return {m.mean * factor, m.standard_error * factor, m.degrees, m.skewness};
}

/// p-value of "every mean is the exact one"; slack: what exact values err by, relative to them.
inline double exact_p_value(const std::vector<RunningMean>& means, const std::vector<double>& exact,
                            double slack) {
    std::vector<double> p;
    for (std::size_t i = 0; i < means.size(); ++i) {
        MeanEstimate ours = estimate_of(means[i]);
        ours.standard_error = std::hypot(ours.standard_error, slack * exact[i]);
        p.push_back(welch_p_value(ours, {exact[i], 0}));
    }
    return holm_minimum(p);
}

}  // namespace burnish::test
