// Rays against the shapes that have no triangles.
#pragma once

#include <array>
#include <cmath>

#include "core/vec.h"
#include "scene/shape.h"

namespace burnish {

/// Distances to both sides of a sphere, nearest first; NaN where the ray misses. Solved in double:
/// a float discriminant loses the silhouette of distant spheres. Without a branch, so that a loop
/// over rays becomes vector code.
inline std::array<float, 2> sphere_hits(const Sphere& sphere, const Vec3f& origin,
                                        const Vec3f& direction) {
    const Vec3<double> o{double{origin.x} - sphere.center.x, double{origin.y} - sphere.center.y,
                         double{origin.z} - sphere.center.z};
    const Vec3<double> d = to_double(direction);
    const double a = dot(d, d), b = dot(o, d), closest = -b / a;
    const Vec3<double> nearest = o + d * closest;
    const double half =
        std::sqrt((double{sphere.radius} * sphere.radius - dot(nearest, nearest)) / a);
    return {static_cast<float>(closest - half), static_cast<float>(closest + half)};
}

/// Distances along the ray, in units of the direction, nearest first; NaN where there are none. Of
/// a mesh and of an instance, which Embree meets by itself: none.
std::array<float, 2> analytic_hits(const Geometry& geometry, const Vec3f& origin,
                                   const Vec3f& direction);

/// The first of two distances within (near, far), or NaN.
inline float first_within(const std::array<float, 2>& distances, float near, float far) {
    const auto within = [&](float t) { return t > near && t < far ? t : NAN; };
    const float first = within(distances[0]), second = within(distances[1]);
    return std::isnan(first) ? second : first;
}

}  // namespace burnish
