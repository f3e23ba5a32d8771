// The memory in which the bands of path caches add up gradients (gradient/texel_sums.h).
#pragma once

#include <span>
#include <vector>

#include "gradient/binding.h"

namespace burnish {

/// Bytes of the blocks of texels that the bands of any of the views come to, each band for itself:
/// as many as a trial of some camera samples promises, with kTrialMargin. One view uses them at a
/// time, but none gives them back. reaching: reaching_pixels of each view.
double band_bytes(std::span<const TracedScene> views, std::span<const std::vector<char>> reaching,
                  const Theta& theta, std::uint32_t seed);

}  // namespace burnish
