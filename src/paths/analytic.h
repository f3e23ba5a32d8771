// Rays against the shapes that have no triangles.
#pragma once

#include <array>

#include "core/vec.h"
#include "scene/shape.h"

namespace burnish {

/// Distances along the ray, in units of the direction, nearest first; NaN where there are none. Of
/// a mesh and of an instance, which Embree meets by itself: none.
std::array<float, 2> analytic_hits(const Geometry& geometry, const Vec3f& origin,
                                   const Vec3f& direction);

}  // namespace burnish
