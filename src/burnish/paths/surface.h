// Where a ray meets the scene: position, shading frame and texture coordinate, as Mitsuba defines
// them.
#pragma once

#include "burnish/core/frame.h"
#include "burnish/paths/triangles.h"
#include "burnish/scene/scene.h"

namespace burnish {

/// A hit as Accel reports it, for one ray.
struct Hit {
    std::int32_t shape = -1, primitive = 0;
    float distance = 0, u = 0, v = 0;
};

struct Surface {
    Vec3f position;
    Vec3f geometric_normal;  ///< unit, the side that emits
    Frame shading;           ///< n is the interpolated normal, s follows the increase of u
    Vec2f uv;
};

/// The surface at a valid hit of the ray.
Surface surface_at(const Scene& scene, const TriangleTable& triangles, const Hit& hit,
                   const Vec3f& origin, const Vec3f& direction);

/// Position and normals only: what a light needs.
struct SurfacePoint {
    Vec3f position, geometric_normal, shading_normal;
};

inline SurfacePoint triangle_point(const TriangleRecord& r, float u, float v) {
    const float w = 1.0f - u - v;
    return {r.p0 + r.edge1 * u + r.edge2 * v, r.geometric_normal,
            normalize(r.normal[0] * w + r.normal[1] * u + r.normal[2] * v)};
}

/// The origin of a ray that leaves `surface` towards `direction`, moved off the surface by a
/// distance that covers the rounding of the position.
inline Vec3f leave_surface(const Vec3f& position, const Vec3f& geometric_normal,
                           const Vec3f& direction) {
    constexpr float kRelative =
        8.9e-5f;  // 1500 ulps: positions are interpolated and transformed in float
    const float scale =
        (1.0f + std::fmax(std::fabs(position.x),
                          std::fmax(std::fabs(position.y), std::fabs(position.z)))) *
        kRelative;
    return position + geometric_normal * std::copysign(scale, dot(geometric_normal, direction));
}

}  // namespace burnish
