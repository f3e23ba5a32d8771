// Boxes along the axes.
#pragma once

#include <algorithm>

#include "core/constants.h"
#include "core/vec.h"

namespace burnish {

/// From its least to its largest corner; empty unless something was included.
struct Box {
    Vec3f low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};

    void include(const Vec3f& p) { include(Box{p, p}); }
    void include(const Box& b) {
        low = {std::min(low.x, b.low.x), std::min(low.y, b.low.y), std::min(low.z, b.low.z)};
        high = {std::max(high.x, b.high.x), std::max(high.y, b.high.y), std::max(high.z, b.high.z)};
    }
    bool empty() const { return !(low.x <= high.x && low.y <= high.y && low.z <= high.z); }
    Vec3f center() const { return (low + high) * 0.5f; }
    Vec3f size() const { return high - low; }
};

}  // namespace burnish
