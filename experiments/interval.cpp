#include "experiments/interval.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace burnish {

namespace {

/// The 97.5th percentile of Student's distribution with `degrees` >= 1 degrees of freedom.
double student_percentile(std::size_t degrees) {
    constexpr double kTable[] = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306,
                                 2.262,  2.228, 2.201, 2.179, 2.160, 2.145, 2.131, 2.120};
    if (degrees <= std::size(kTable)) return kTable[degrees - 1];
    const double n = static_cast<double>(degrees);
    return 1.96 + 2.37 / n + 2.8 / (n * n);  // Cornish-Fisher, to three digits
}

bool has_interval(const RatioInterval& i) { return std::isfinite(i.high); }

constexpr const char* kTooNoisy = "too noisy to tell";

}  // namespace

RatioInterval ratio_interval(std::span<const double> ratios) {
    RatioInterval interval;
    if (ratios.empty()) return interval;
    const auto usable = [](double r) { return r > 0 && std::isfinite(r); };
    if (!std::all_of(ratios.begin(), ratios.end(), usable)) {
        interval.ratio = std::numeric_limits<double>::quiet_NaN();
        return interval;
    }
    const double n = static_cast<double>(ratios.size());
    double mean = 0, squares = 0;
    for (const double r : ratios) mean += std::log(r) / n;
    interval.ratio = std::exp(mean);
    if (ratios.size() < 2) return interval;
    for (const double r : ratios) squares += std::pow(std::log(r) - mean, 2);
    const double error = std::sqrt(squares / (n - 1) / n);
    const double half = student_percentile(ratios.size() - 1) * error;
    interval.low = std::exp(mean - half), interval.high = std::exp(mean + half);
    return interval;
}

double positive_ratio(double a, double b) {
    return a > 0 && b > 0 ? a / b : std::numeric_limits<double>::quiet_NaN();
}

std::string interval_text(std::size_t runs) {
    return runs == 1 ? "one run, no interval"
                     : fmt::format("with 95 % intervals over {} runs", runs);
}

std::string text_of(const RatioInterval& i) {
    if (std::isnan(i.ratio)) return kTooNoisy;
    if (!has_interval(i)) return fmt::format("{:.2f}", i.ratio);
    return fmt::format("{:.2f} [{:.2f}, {:.2f}]", i.ratio, i.low, i.high);
}

std::string multiple_text(double a, double b, const std::string& what) {
    const double ratio = positive_ratio(a, b);
    return std::isnan(ratio) ? fmt::format("an error {}", kTooNoisy)
                             : fmt::format("{:.2f} times {}", ratio, what);
}

std::string share_text(double share) {
    if (std::isnan(share)) return kTooNoisy;
    const double percent = 100 * share;
    return percent < 10 ? fmt::format("{:.2g} %", percent) : fmt::format("{:.0f} %", percent);
}

std::string nmse_text(double error) {
    return std::isfinite(error) ? fmt::format("{:.3g}", error) : kTooNoisy;
}

Verdict verdict_below_one(const RatioInterval& interval) {
    if (interval.high < 1) return Verdict::kHolds;
    if (interval.low > 1) return Verdict::kFails;
    return Verdict::kUndecided;
}

Verdict verdict_below_one(const RatioInterval& first, const RatioInterval& second) {
    return verdict_of_ways(verdict_below_one(first), verdict_below_one(second));
}

RatioInterval in_units_of(const RatioInterval& interval, double unit) {
    return {interval.ratio / unit, interval.low / unit, interval.high / unit};
}

bool stands_above_one(const RatioInterval& interval) {
    return interval.low > 1 || (!has_interval(interval) && interval.ratio > 1);
}

bool stands_below_one(const RatioInterval& interval) {
    return interval.high < 1 || (!has_interval(interval) && interval.ratio < 1);
}

std::string reason_of_doubt(const RatioInterval& interval, const std::string& part,
                            const std::string& hiding, double bound) {
    if (std::isnan(interval.ratio))
        return fmt::format("The noise of {} hides what {} does.", hiding, part);
    return fmt::format("The interval of {} holds {:g}: more runs would decide.", part, bound);
}

Verdict bounds_below_one(const RatioInterval& bounds) {
    return verdict_below_one(bounds) == Verdict::kHolds ? Verdict::kHolds : Verdict::kUndecided;
}

Verdict verdict_of_ways(Verdict first, Verdict second) {
    const bool second_does = second == Verdict::kHolds || second == Verdict::kPartly;
    return first != Verdict::kHolds && second_does ? Verdict::kPartly : first;
}

Verdict verdict_of_parts(Verdict first, Verdict second) {
    const auto any = [&](Verdict v) { return first == v || second == v; };
    if (first == second) return first;
    if (any(Verdict::kHolds) || any(Verdict::kPartly)) return Verdict::kPartly;
    return any(Verdict::kFails) ? Verdict::kFails : Verdict::kUndecided;
}

Verdict late_verdict(const RatioInterval& mc, const RatioInterval& pgris,
                     const RatioInterval& pgris_over_mc) {
    const Verdict goes_on = verdict_below_one(pgris), more = verdict_below_one(pgris_over_mc);
    if (goes_on == Verdict::kFails || more == Verdict::kFails) return Verdict::kFails;
    if (goes_on == Verdict::kUndecided) return Verdict::kUndecided;
    const Verdict falls = verdict_below_one(in_units_of(mc, kConverged));
    if (falls == Verdict::kHolds) return Verdict::kFails;
    return falls == Verdict::kFails ? more : Verdict::kUndecided;
}

Verdict floor_verdict(const RatioInterval& ris, const RatioInterval& pris) {
    const RatioInterval pris_left{1 / pris.ratio, 1 / pris.high, 1 / pris.low};
    return verdict_of_parts(verdict_below_one(in_units_of(ris, 1.25)),
                            verdict_below_one(in_units_of(pris_left, 0.25)));
}

}  // namespace burnish
