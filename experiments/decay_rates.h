// What runs over Adam's decay rates tell of a method beside the baseline.
#pragma once

#include <span>

#include "experiments/interval.h"

namespace burnish {

struct DecayComparison {
    RatioInterval ratio;        ///< of losses, the method's over the baseline's, pair by pair
    int wins = 0;               ///< pairs of decay rates with the lower loss
    double spread_percent = 0;  ///< of the method's losses, see spread_percent
    Verdict verdict = Verdict::kUndecided;
};

/// How much the largest of losses is above the smallest; NaN unless all are above 0.
double spread_percent(std::span<const double> losses);

/// Of the claim that the method outperforms the baseline and that its losses differ by less than
/// 10 %: kPartly where the first holds and the losses, of single runs, differ by more, which may be
/// their noise. The losses, without that of their evaluation, are those of the same pairs of decay
/// rates.
DecayComparison compare_decay(std::span<const double> method, std::span<const double> baseline);

}  // namespace burnish
