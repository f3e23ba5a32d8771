// The contribution that stands out: the largest derivative that a single path brings to a texel.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

#include "core/vec.h"
#include "paths/path.h"

namespace burnish {

/// A contribution that stands out, named so that it can be found. Value 0: none.
struct Outlier {
    float value = 0;  ///< largest channel of |g|
    std::uint32_t pixel = 0, slot = 0, texel = 0;
    Technique technique = Technique::kEmitter;
};

/// What a contribution of a texel is measured by.
inline float largest_channel(const Rgbf& g) {
    return std::max({std::fabs(g.x), std::fabs(g.y), std::fabs(g.z)});
}

/// Whether `a` is the larger. Equal values are in the order of their names, so that the largest of
/// many does not depend on their order.
inline bool stands_out_more(const Outlier& a, const Outlier& b) {
    const auto name = [](const Outlier& e) {
        return std::tuple(e.slot, e.texel, e.pixel, e.technique);
    };
    return a.value != b.value ? a.value > b.value : name(a) < name(b);
}

}  // namespace burnish
