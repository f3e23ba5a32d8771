#include "paths/analytic.h"

#include <cmath>

#include "core/variant.h"

namespace burnish {

namespace {

std::array<float, 2> hit_disk(const Disk& disk, const Vec3f& origin, const Vec3f& direction) {
    const Vec3f o = transform_point(disk.to_local, origin),
                d = transform_vector(disk.to_local, direction);
    const float t = -o.z / d.z;
    const float x = o.x + t * d.x, y = o.y + t * d.y;
    return {x * x + y * y <= 1.0f ? t : NAN, NAN};
}

/// In double, as of a sphere; NaN where the ray misses, or meets beyond the ends.
std::array<float, 2> hit_cylinder(const Cylinder& cylinder, const Vec3f& origin,
                                  const Vec3f& direction) {
    const Transform& m = cylinder.to_local;
    const auto to_local = [&](const Vec3f& v, double w, int row) {
        return m(row, 0) * double{v.x} + m(row, 1) * double{v.y} + m(row, 2) * double{v.z} +
               m(row, 3) * w;
    };
    const double ox = to_local(origin, 1, 0), oy = to_local(origin, 1, 1),
                 oz = to_local(origin, 1, 2), dx = to_local(direction, 0, 0),
                 dy = to_local(direction, 0, 1), dz = to_local(direction, 0, 2);
    const double a = dx * dx + dy * dy, closest = -(ox * dx + oy * dy) / a;
    const double nx = ox + dx * closest, ny = oy + dy * closest;
    const double half_squared = (1 - nx * nx - ny * ny) / a;
    if (!(a > 0) || !(half_squared >= 0)) return {NAN, NAN};
    const double half = std::sqrt(half_squared);
    const auto within = [&](double t) {
        const double z = oz + dz * t;
        return z >= 0 && z <= 1 ? static_cast<float>(t) : NAN;
    };
    return {within(closest - half), within(closest + half)};
}

}  // namespace

std::array<float, 2> analytic_hits(const Geometry& geometry, const Vec3f& origin,
                                   const Vec3f& direction) {
    return match(
        geometry,
        [](const Mesh&) {
            return std::array<float, 2>{NAN, NAN};
        },
        [&](const Sphere& sphere) { return sphere_hits(sphere, origin, direction); },
        [&](const Disk& disk) { return hit_disk(disk, origin, direction); },
        [&](const Cylinder& cylinder) { return hit_cylinder(cylinder, origin, direction); },
        [](const Instance&) {
            return std::array<float, 2>{NAN, NAN};
        });
}

}  // namespace burnish
