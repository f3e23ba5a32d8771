// A hit as Accel reports it, for one ray.
#pragma once

#include <cstdint>

namespace burnish {

struct Hit {
    std::int32_t shape = -1, primitive = 0;  ///< shape -1: nothing was hit
    float distance = 0, u = 0, v = 0;

    friend bool operator==(const Hit&, const Hit&) = default;
};

}  // namespace burnish
