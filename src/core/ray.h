// A ray in world space.
#pragma once

#include "core/vec.h"

namespace burnish {

struct Ray {
    Vec3f origin;
    Vec3f direction;     ///< unit
    float max_distance;  ///< along direction
};

}  // namespace burnish
