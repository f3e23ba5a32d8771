// Why derivatives with reuse are not more exact in the same time.
#pragma once

#include <cstdint>
#include <string>

#include "experiments/interval.h"

namespace burnish {

/// Of the claim that the error of pgris is less than `bound` of that of mc: kPartly where it holds
/// with the identity shift alone.
Verdict derivatives_verdict(const RatioInterval& replay, const RatioInterval& identity,
                            double bound);

/// Why the claim does not hold of the replay shift, whose error is so much of that of mc, and less
/// than `bound` of it in the claim; empty where neither the verdict of the figure nor a single run
/// is against it. seconds: of mc with one sample per pixel. samples: of mc, per pixel, that take
/// about the time of pgris with replay.
std::string derivatives_reason(const RatioInterval& replay, double bound, Verdict of_figure,
                               double seconds, std::uint32_t samples);

}  // namespace burnish
