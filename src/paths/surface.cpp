#include "paths/surface.h"

#include <algorithm>
#include <numbers>

#include "core/variant.h"

namespace burnish {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

Surface at_sphere(const Sphere& sphere, const Vec3f& hit_position) {
    Surface s;
    const Vec3f outward = normalize(hit_position - sphere.center);
    s.position = sphere.center + outward * sphere.radius;
    // Columns of the rotation are the local axes in the world.
    const auto axis = [&](int i) {
        return normalize(Vec3f{static_cast<float>(sphere.to_world(0, i)),
                               static_cast<float>(sphere.to_world(1, i)),
                               static_cast<float>(sphere.to_world(2, i))});
    };
    const Vec3f ax = axis(0), ay = axis(1), az = axis(2);
    const Vec3f local{dot(outward, ax), dot(outward, ay), dot(outward, az)};
    float azimuth = std::atan2(local.y, local.x);
    if (azimuth < 0) azimuth += 2 * kPi;
    s.uv = {azimuth / (2 * kPi), std::acos(std::clamp(local.z, -1.0f, 1.0f)) / kPi};
    const Vec3f dp_du = local.x == 0 && local.y == 0 ? ax : ax * -local.y + ay * local.x;
    s.geometric_normal = sphere.flip_normals ? -outward : outward;
    s.shading = frame_from_tangent(s.geometric_normal, dp_du);
    return s;
}

Surface at_disk(const Disk& disk, const Vec3f& hit_position) {
    Surface s;
    s.position = hit_position;
    const Vec3f local = transform_point(disk.to_local, hit_position);
    const float r = std::sqrt(local.x * local.x + local.y * local.y);
    float azimuth = std::atan2(local.y, local.x);
    if (azimuth < 0) azimuth += 2 * kPi;
    s.uv = {r, azimuth / (2 * kPi)};
    const Vec3f n = transform_normal(disk.to_local, {0, 0, 1});
    const Vec3f radial = r > 0 ? Vec3f{local.x / r, local.y / r, 0} : Vec3f{1, 0, 0};
    s.geometric_normal = disk.flip_normals ? -n : n;
    s.shading = frame_from_tangent(s.geometric_normal, transform_vector(disk.to_world, radial));
    return s;
}

}  // namespace

Surface surface_at(const Scene& scene, const TriangleTable& triangles, const Hit& hit,
                   const Vec3f& origin, const Vec3f& direction) {
    const auto shape = static_cast<std::size_t>(hit.shape);
    if (!triangles[shape].empty())
        return triangle_surface(triangles[shape][static_cast<std::size_t>(hit.primitive)], hit.u,
                                hit.v);
    const Geometry& geometry = scene.shapes[shape].geometry;
    const Vec3f position = origin + direction * hit.distance;
    return match(
        geometry, [](const Mesh&) { return Surface{}; },  // its triangles are above
        [&](const Sphere& sphere) { return at_sphere(sphere, position); },
        [&](const Disk& disk) { return at_disk(disk, position); });
}

}  // namespace burnish
