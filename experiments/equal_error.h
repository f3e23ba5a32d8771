// Runs of pgris beside what the baseline needs for the same error, and what they say.
#pragma once

#include <span>
#include <string>

#include "experiments/interval.h"

namespace burnish {

/// Where the error of the baseline first falls to a goal; NaN where noise hides one of the two.
struct Crossing {
    double samples = 1, seconds = 0;
    bool is_bound = false;  ///< it does not, and these are those of the last try: it takes more
};

/// pgris with random numbers of one run, beside what mc needs with the same for its error.
struct EqualErrorRun {
    double nmse = 0, seconds = 0;
    Crossing mc;
};

/// Whether a run is a bound: then what mc needs is at least that, and the ratio of seconds at most.
bool has_bound(std::span<const EqualErrorRun> runs);
/// Of pgris over those of mc.
RatioInterval seconds_ratio(std::span<const EqualErrorRun> runs);
/// Of the claim that pgris takes less time. A bound may tell that it does, never that it does not.
Verdict verdict_of(std::span<const EqualErrorRun> runs);
/// Why the claim does not hold of the replay shift; empty where neither the verdict of the figure
/// nor a single run is against it.
std::string equal_error_reason(std::span<const EqualErrorRun> replay, Verdict of_figure);

}  // namespace burnish
