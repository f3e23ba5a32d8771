#include "paths/surface.h"

#include <algorithm>

#include "core/constants.h"
#include "core/variant.h"

namespace burnish {

namespace {

/// The azimuth of (x, y), 0 to 1.
float turns_of(float y, float x) {
    const float azimuth = std::atan2(y, x);
    return (azimuth < 0 ? azimuth + 2 * kPi : azimuth) / (2 * kPi);
}

Surface at_sphere(const Sphere& sphere, const Vec3f& hit_position) {
    const SphereAxes axes = axes_of(sphere);
    Surface s = sphere_surface(sphere, axes, hit_position);
    const Vec3f outward = normalize(hit_position - sphere.center);
    s.uv = {turns_of(dot(outward, axes[1]), dot(outward, axes[0])),
            std::acos(std::clamp(dot(outward, axes[2]), -1.0f, 1.0f)) / kPi};
    return s;
}

Surface at_disk(const Disk& disk, const Vec3f& hit_position) {
    Surface s;
    s.position = hit_position;
    const Vec3f local = transform_point(disk.to_local, hit_position);
    const float r = std::sqrt(local.x * local.x + local.y * local.y);
    s.uv = {r, turns_of(local.y, local.x)};
    const Vec3f n = transform_normal(disk.to_local, {0, 0, 1});
    const Vec3f radial = r > 0 ? Vec3f{local.x / r, local.y / r, 0} : Vec3f{1, 0, 0};
    s.geometric_normal = disk.flip_normals ? -n : n;
    s.shading = frame_from_tangent(s.geometric_normal, transform_vector(disk.to_world, radial));
    return s;
}

Surface at_cylinder(const Cylinder& cylinder, const Vec3f& hit_position) {
    Surface s;
    s.position = hit_position;
    const Vec3f local = transform_point(cylinder.to_local, hit_position);
    s.uv = {turns_of(local.y, local.x), local.z};
    const Vec3f n = transform_normal(cylinder.to_local, {local.x, local.y, 0});
    s.geometric_normal = cylinder.flip_normals ? -n : n;
    s.shading = frame_from_tangent(s.geometric_normal,
                                   transform_vector(cylinder.to_world, {-local.y, local.x, 0}));
    return s;
}

/// A triangle of a prototype, where an instance has it.
Surface at_triangle(const Instance& instance, const TriangleRecord& record, const Hit& hit) {
    const Surface local = triangle_surface(record, hit.u, hit.v);
    return {transform_point(instance.to_world, local.position),
            transform_normal(instance.to_local, local.geometric_normal),
            frame_from_tangent(transform_normal(instance.to_local, local.shading.n),
                               transform_vector(instance.to_world, record.dp_du)),
            local.uv};
}

/// What an instance has on a shape without triangles; local: the surface of its prototype.
Surface at_analytic(const Instance& instance, const Surface& local) {
    return {transform_point(instance.to_world, local.position),
            transform_normal(instance.to_local, local.geometric_normal),
            frame_from_tangent(transform_normal(instance.to_local, local.shading.n),
                               transform_vector(instance.to_world, local.shading.s)),
            local.uv};
}

Surface at_analytic(const Geometry& geometry, const Vec3f& position) {
    return match(
        geometry, [](const Mesh&) { return Surface{}; },  // has records
        [&](const Sphere& sphere) { return at_sphere(sphere, position); },
        [&](const Disk& disk) { return at_disk(disk, position); },
        [&](const Cylinder& cylinder) { return at_cylinder(cylinder, position); },
        [](const Instance&) { return Surface{}; });  // has a prototype
}

// A turn of u is 2 pi of azimuth.

Tangents tangents_on(const Sphere& sphere, const Vec3f& position) {
    const SphereAxes axes = axes_of(sphere);
    const Vec3f d = normalize(position - sphere.center);
    const float x = dot(d, axes[0]), y = dot(d, axes[1]), z = dot(d, axes[2]);
    const float r = std::sqrt(x * x + y * y);
    const Vec3f radial = r > 0 ? (axes[0] * x + axes[1] * y) * (1 / r) : axes[0];
    return {(axes[1] * x - axes[0] * y) * (2 * kPi * sphere.radius),
            (radial * z - axes[2] * r) * (kPi * sphere.radius)};
}

Tangents tangents_on(const Disk& disk, const Vec3f& position) {
    const Vec3f local = transform_point(disk.to_local, position);
    const float r = std::sqrt(local.x * local.x + local.y * local.y);
    const Vec3f radial = r > 0 ? Vec3f{local.x / r, local.y / r, 0} : Vec3f{1, 0, 0};
    return {transform_vector(disk.to_world, radial),
            transform_vector(disk.to_world, Vec3f{-local.y, local.x, 0} * (2 * kPi))};
}

Tangents tangents_on(const Cylinder& cylinder, const Vec3f& position) {
    const Vec3f local = transform_point(cylinder.to_local, position);
    return {transform_vector(cylinder.to_world, Vec3f{-local.y, local.x, 0} * (2 * kPi)),
            transform_vector(cylinder.to_world, {0, 0, 1})};
}

}  // namespace

SphereAxes axes_of(const Sphere& sphere) {
    // Columns of the rotation.
    const auto axis = [&](int i) {
        return normalize(Vec3f{static_cast<float>(sphere.to_world(0, i)),
                               static_cast<float>(sphere.to_world(1, i)),
                               static_cast<float>(sphere.to_world(2, i))});
    };
    return {axis(0), axis(1), axis(2)};
}

namespace {

/// Those of a shape, or of what it is an instance of; none: it has no triangles.
const std::vector<TriangleRecord>& triangles_of(const Scene& scene, const TriangleTable& triangles,
                                                std::int32_t shape) {
    const auto i = static_cast<std::size_t>(shape);
    const auto* instance = std::get_if<Instance>(&scene.shapes[i].geometry);
    return triangles[instance ? scene.shapes.size() + instance->prototype : i];
}

}  // namespace

bool is_hit(const Scene& scene, const TriangleTable& triangles, const Hit& hit) {
    constexpr float kFar = 1e18f;  // its square is finite
    if (hit.shape < 0 || static_cast<std::size_t>(hit.shape) >= scene.shapes.size()) return false;
    if (!(hit.distance >= 0 && hit.distance < kFar)) return false;
    const auto& records = triangles_of(scene, triangles, hit.shape);
    const auto is_weight = [](float w) { return w > -1 && w < 2; };  // up to rounding in [0, 1]
    return records.empty() ||
           (hit.primitive >= 0 && static_cast<std::size_t>(hit.primitive) < records.size() &&
            is_weight(hit.u) && is_weight(hit.v));
}

Surface surface_at(const Scene& scene, const TriangleTable& triangles, const Hit& hit,
                   const Vec3f& origin, const Vec3f& direction) {
    const auto shape = static_cast<std::size_t>(hit.shape);
    if (!triangles[shape].empty())
        return triangle_surface(triangles[shape][static_cast<std::size_t>(hit.primitive)], hit.u,
                                hit.v);
    const Geometry& geometry = scene.shapes[shape].geometry;
    const Vec3f position = origin + direction * hit.distance;
    const auto* instance = std::get_if<Instance>(&geometry);
    if (!instance) return at_analytic(geometry, position);
    const auto& records = triangles[scene.shapes.size() + instance->prototype];
    if (!records.empty())
        return at_triangle(*instance, records[static_cast<std::size_t>(hit.primitive)], hit);
    return at_analytic(*instance, at_analytic(scene.prototypes[instance->prototype].geometry,
                                              transform_point(instance->to_local, position)));
}

Tangents tangents_at(const Scene& scene, const Hit& hit, const Vec3f& position) {
    const auto on = [&](const auto& self, const Geometry& geometry, const Vec3f& p) -> Tangents {
        return match(
            geometry,
            [&](const Mesh& mesh) {
                return tangents_of(mesh, static_cast<std::size_t>(hit.primitive));
            },
            [&](const Instance& instance) {
                const Tangents local = self(self, scene.prototypes[instance.prototype].geometry,
                                            transform_point(instance.to_local, p));
                return Tangents{transform_vector(instance.to_world, local.dp_du),
                                transform_vector(instance.to_world, local.dp_dv)};
            },
            [&](const Sphere& sphere) { return tangents_on(sphere, p); },
            [&](const Disk& disk) { return tangents_on(disk, p); },
            [&](const Cylinder& cylinder) { return tangents_on(cylinder, p); });
    };
    return on(on, scene.shapes[static_cast<std::size_t>(hit.shape)].geometry, position);
}

Vec2f uv_at(const Scene& scene, const TriangleTable& triangles, const Hit& hit, const Vec3f& origin,
            const Vec3f& direction) {
    const auto& records = triangles_of(scene, triangles, hit.shape);
    if (records.empty()) return surface_at(scene, triangles, hit, origin, direction).uv;
    return triangle_uv(records[static_cast<std::size_t>(hit.primitive)], hit.u, hit.v);
}

}  // namespace burnish
