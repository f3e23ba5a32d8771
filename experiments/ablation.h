// What the ablation says of its claim.
#pragma once

#include <string>

#include "experiments/interval.h"

namespace burnish {

/// Why positivization does not pay.
inline constexpr const char* kPositivizationReason =
    "A second reservoir pays where the samples of a texel differ in sign; where they hardly do, "
    "one with |q| does as well.";

/// Why the claim does not hold, or not all of it; empty where neither the verdict nor a single run
/// is against it. The error of pgris over that of gris, which is not positivized, and over that of
/// pris, which does not reuse.
std::string ablation_reason(const RatioInterval& positivization, const RatioInterval& reuse);

}  // namespace burnish
