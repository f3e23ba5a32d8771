// Statistics that tests share: p-values, and their correction so that many tests share one alpha.
// A p-value is the probability, if the hypothesis is true, of data at least as extreme; reject
// where it is below alpha. Of data that are not numbers it is not a number, which is neither below
// nor above alpha: a test fails, and a seeded defect does not count as rejected.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

namespace burnish::test {

/// The regularised upper incomplete gamma function Q(a, x), a > 0, x >= 0, to about 1e-14: the
/// series of P below x = a + 1, the continued fraction of Q (modified Lentz) above.
inline double gamma_q(double a, double x) {
    if (std::isnan(x)) return x;
    if (!(x > 0)) return 1;
    const double scale = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (double k = a + 1; term > sum * 1e-16; ++k) sum += term *= x / k;
        return std::max(0.0, 1 - sum * scale);
    }
    constexpr double kTiny = std::numeric_limits<double>::min();
    double b = x + 1 - a, c = 1 / kTiny, d = 1 / b, h = d;
    for (int i = 1; i < 100000; ++i) {
        const double an = -i * (i - a);
        b += 2;
        d = an * d + b;
        d = 1 / (std::abs(d) < kTiny ? kTiny : d);
        c = b + an / c;
        c = std::abs(c) < kTiny ? kTiny : c;
        h *= d * c;
        if (std::abs(d * c - 1) < 1e-15) break;
    }
    return scale * h;
}

/// P(X >= statistic) for X chi-square distributed with `degrees` > 0 degrees of freedom.
inline double chi_square_p_value(double statistic, double degrees) {
    return gamma_q(0.5 * degrees, 0.5 * statistic);
}

/// P(|X| >= |z|) for X standard normal.
inline double normal_p_value(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

/// Two-sided p-value of "the mean is `expected`", by the central limit theorem: for many samples.
/// Not a number where a mean or the error is not finite.
inline double mean_p_value(double mean, double standard_error, double expected) {
    if (!std::isfinite(standard_error) || !std::isfinite(mean - expected))
        return std::numeric_limits<double>::quiet_NaN();
    if (standard_error > 0) return normal_p_value((mean - expected) / standard_error);
    return mean == expected ? 1 : 0;
}

/// The smallest Holm-adjusted p-value, i.e. Bonferroni's: with all hypotheses true the probability
/// that it is below alpha is at most alpha, whatever the dependence; reject the family where it is.
/// 1 where empty; not a number where a p-value is not.
inline double holm_minimum(const std::vector<double>& p) {
    for (const double x : p)
        if (std::isnan(x)) return x;
    const auto min = std::min_element(p.begin(), p.end());
    return min == p.end() ? 1 : std::min(1.0, *min * static_cast<double>(p.size()));
}

/// Mean, variance and skewness as numbers arrive [Welford 1962; Terriberry 2007].
struct RunningMean {
    double count = 0, mean = 0, squares = 0, cubes = 0;

    void add(double x) {
        const double before = x - mean, step = before / ++count;
        cubes += step * (before * step * (count - 1) * (count - 2) - 3 * squares);
        mean += step;
        squares += before * (x - mean);
    }
    double variance() const { return count > 1 ? squares / (count - 1) : 0; }
    double standard_error() const { return count > 1 ? std::sqrt(variance() / count) : 0; }
    /// Third central moment over the cube of the standard deviation.
    double skewness() const {
        return squares > 0 ? cubes * std::sqrt(count) / (squares * std::sqrt(squares)) : 0;
    }
};

/// Of the numbers times a factor.
inline RunningMean larger_by(double factor, RunningMean m) {
    m.mean *= factor, m.squares *= factor * factor, m.cubes *= factor * factor * factor;
    return m;
}

/// p-value of the goodness of fit of counts to expected counts (same total where nothing is lost).
/// Bins are pooled in ascending order of expectation until each pool expects at least `min`; a
/// count where nothing is expected is impossible and gives 0.
inline double goodness_of_fit_p_value(const std::vector<double>& observed,
                                      const std::vector<double>& expected, double min = 5) {
    for (std::size_t i = 0; i < observed.size(); ++i)
        if (std::isnan(observed[i] + expected[i])) return observed[i] + expected[i];
    std::vector<std::size_t> order(observed.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return expected[a] < expected[b]; });
    double statistic = 0, o = 0, e = 0, pools = 0;
    for (std::size_t rank = 0; rank < order.size(); ++rank) {
        const std::size_t i = order[rank];
        if (expected[i] <= 0 && observed[i] > 0) return 0;
        o += observed[i];
        e += expected[i];
        if (e < min && rank + 1 < order.size()) continue;
        if (e > 0) statistic += (o - e) * (o - e) / e, ++pools;
        o = e = 0;
    }
    return pools > 1 ? chi_square_p_value(statistic, pools - 1) : 1;
}

}  // namespace burnish::test
