// Contributions that stand out: the largest derivatives that single paths bring to single texels.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/vec.h"
#include "paths/path.h"

namespace burnish {

/// A contribution that stands out, named so that it can be found.
struct Outlier {
    float value = 0;  ///< largest channel of |g|
    std::uint32_t pixel = 0, slot = 0, texel = 0;
    Technique technique = Technique::kEmitter;
};
inline constexpr std::size_t kMaxOutliers = 8;

/// What a contribution of a texel is measured by.
inline float largest_channel(const Rgbf& g) {
    return std::max({std::fabs(g.x), std::fabs(g.y), std::fabs(g.z)});
}

/// Cuts a list to its kMaxOutliers largest, largest first. Equal values are in the order of their
/// names, so that the result does not depend on the order of the list.
void keep_largest(std::vector<Outlier>& list);

}  // namespace burnish
