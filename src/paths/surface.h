// Where a ray meets the scene: position, shading frame and texture coordinate, as Mitsuba defines
// them.
#pragma once

#include "core/frame.h"
#include "paths/hit.h"
#include "paths/triangles.h"
#include "scene/scene.h"

namespace burnish {

/// T: float, or Packet for sixteen surfaces.
template <class T>
struct SurfaceOf {
    Vec3<T> position;
    Vec3<T> geometric_normal;  ///< unit, the side that emits
    FrameOf<T> shading;        ///< n is the interpolated normal, s follows the increase of u
    Vec2<T> uv;
};
using Surface = SurfaceOf<float>;

/// Whether a ray can have such a hit: on a shape of the scene, and a triangle that it has.
bool is_hit(const Scene& scene, const TriangleTable& triangles, const Hit& hit);

/// The surface at a valid hit of the ray.
Surface surface_at(const Scene& scene, const TriangleTable& triangles, const Hit& hit,
                   const Vec3f& origin, const Vec3f& direction);

/// Its texture coordinate alone.
Vec2f uv_at(const Scene& scene, const TriangleTable& triangles, const Hit& hit, const Vec3f& origin,
            const Vec3f& direction);

/// Its derivatives by the texture coordinate, at its position. Slower than the rest of a surface.
Tangents tangents_at(const Scene& scene, const Hit& hit, const Vec3f& position);

/// Where the texture of a sphere lies: its local axes in the world.
using SphereAxes = std::array<Vec3f, 3>;
SphereAxes axes_of(const Sphere& sphere);

/// The surface of a sphere at a point near it; uv is not set.
template <class T>
SurfaceOf<T> sphere_surface(const Sphere& sphere, const SphereAxes& axes, const Vec3<T>& near) {
    const auto each = [](const Vec3f& v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
    const Vec3<T> center = each(sphere.center), ax = each(axes[0]), ay = each(axes[1]);
    const Vec3<T> outward = normalize(near - center);
    const T x = dot(outward, ax), y = dot(outward, ay);
    SurfaceOf<T> s;
    s.position = center + outward * T(sphere.radius);
    s.geometric_normal = sphere.flip_normals ? -outward : outward;
    const auto pole = x == T(0.0f) && y == T(0.0f);
    s.shading = frame_from_tangent(s.geometric_normal, select(pole, ax, ax * -y + ay * x));
    return s;
}

/// Position and normals only: what a light needs.
template <class T>
struct SurfacePoint {
    Vec3<T> position, geometric_normal, shading_normal;
};

/// u, v: weights of vertices 1 and 2.
template <class T>
SurfacePoint<T> triangle_point(const TriangleOf<T>& r, const T& u, const T& v) {
    const T w = T(1.0f) - u - v;
    return {r.p0 + r.edge1 * u + r.edge2 * v, r.geometric_normal,
            normalize(r.normal[0] * w + r.normal[1] * u + r.normal[2] * v)};
}

template <class T>
Vec2<T> triangle_uv(const TriangleOf<T>& r, const T& u, const T& v) {
    return r.uv[0] * (T(1.0f) - u - v) + r.uv[1] * u + r.uv[2] * v;
}

template <class T>
SurfaceOf<T> triangle_surface(const TriangleOf<T>& r, const T& u, const T& v) {
    const SurfacePoint<T> point = triangle_point(r, u, v);
    return {point.position, point.geometric_normal,
            frame_from_tangent(point.shading_normal, r.dp_du), triangle_uv(r, u, v)};
}

/// How far off a surface rays begin, over 1 + the largest coordinate: 1500 ulps, as positions are
/// interpolated and transformed in float.
inline constexpr float kRayOffset = 8.9e-5f;
/// How far before the light shadow rays stop, over the distance: ten times that offset. The light
/// itself is no obstacle.
inline constexpr float kShadowShortening = 8.9e-4f;

/// The origin of a ray that leaves a surface at `position` towards `direction`, moved off it by a
/// distance that covers the rounding of the position.
template <class T>
Vec3<T> leave_surface(const Vec3<T>& position, const Vec3<T>& geometric_normal,
                      const Vec3<T>& direction) {
    const T largest = max(abs(position.x), max(abs(position.y), abs(position.z)));
    const T offset = (T(1.0f) + largest) * T(kRayOffset);
    return position + geometric_normal * mulsign(offset, dot(geometric_normal, direction));
}

}  // namespace burnish
