// Ratios of paired runs, with intervals, and what they say of a claim.
#pragma once

#include <limits>
#include <span>
#include <string>

#include "experiments/figure.h"

namespace burnish {

/// A ratio with its 95 % interval.
struct RatioInterval {
    double ratio = 1, low = 0, high = std::numeric_limits<double>::infinity();
};

/// The geometric mean of the ratios of independent runs, by Student's t of their logarithms. Of a
/// single run, and where a ratio is not positive, the interval is [0, infinity].
RatioInterval ratio_interval(std::span<const double> ratios);

/// a / b of losses or errors without their noise, which may be below 0: NaN unless both are above.
double positive_ratio(double a, double b);

/// "0.62 [0.51, 0.75]"; without an interval "0.62"; of NaN "too noisy to tell".
std::string text_of(const RatioInterval& interval);
/// "0.62 times WHAT", of positive_ratio(a, b), two errors; of NaN "an error too noisy to tell".
std::string multiple_text(double a, double b, const std::string& what);
/// "100 %", "2.5 %": two digits of a share, or all before the point; of NaN "too noisy to tell".
std::string share_text(double share);
/// Three digits of an NMSE; "too noisy to tell" of one that is not finite.
std::string nmse_text(double error);
/// "with 95 % intervals over 5 runs"; of one run "one run, no interval".
std::string interval_text(std::size_t runs);

/// Of the claim that the ratio is below 1: decided where the whole interval lies on one side.
Verdict verdict_below_one(const RatioInterval& interval);
/// The same of two ways to do it: kPartly where the claim holds of the second alone.
Verdict verdict_below_one(const RatioInterval& first, const RatioInterval& second);

/// The ratio as a multiple of `unit`: what is told of 1 is so told of that.
RatioInterval in_units_of(const RatioInterval& interval, double unit);

/// Whether the ratio lies on that side of 1: its whole interval, or the ratio of a single run,
/// which has no interval. Such a run decides nothing, but what it shows may need a reason.
bool stands_above_one(const RatioInterval& interval);
bool stands_below_one(const RatioInterval& interval);

/// Why the interval of `part` does not tell whether its ratio is below `bound`: it holds that, or
/// the noise of `hiding` hides the ratio.
std::string reason_of_doubt(const RatioInterval& interval, const std::string& part,
                            const std::string& hiding, double bound = 1);

/// Of upper bounds of a ratio: they may tell that it is below 1, never that it is not.
Verdict bounds_below_one(const RatioInterval& bounds);

/// Of a claim about two ways to do it, each with its own verdict: kPartly where it holds, in part
/// or all of it, but not all of it of the first.
Verdict verdict_of_ways(Verdict first, Verdict second);
/// Of a claim that has two parts, each with its own verdict.
Verdict verdict_of_parts(Verdict first, Verdict second);
/// A loss has converged that falls by less than a tenth late in a run.
inline constexpr double kConverged = 0.9;
/// Of the claim that the loss of pgris goes on falling where that of mc has converged. What a loss
/// changes by late in a run: of mc, of pgris, and of pgris over that of mc, run by run. mc counts
/// as converged where all of its interval lies above kConverged; where all of it lies below, the
/// claim fails if pgris falls.
Verdict late_verdict(const RatioInterval& mc, const RatioInterval& pgris,
                     const RatioInterval& pgris_over_mc);

/// Of the claim that the variance of ris has a floor and that of pris none. What eight times the
/// candidates divide it by, about 1 and 8: at most 1.25 is a floor, at least 4 is none.
Verdict floor_verdict(const RatioInterval& ris, const RatioInterval& pris);

}  // namespace burnish
