// What looks wrong in space: surfaces that are inside out, lights that are walled in.
#include <fmt/format.h>

#include <cmath>
#include <span>

#include "cli/findings.h"
#include "cli/mesh_check.h"
#include "core/variant.h"
#include "paths/one_ray.h"

namespace burnish {

namespace {

bool holds(const Box& box, const Vec3f& p) {
    return p.x >= box.low.x && p.x <= box.high.x && p.y >= box.low.y && p.y <= box.high.y &&
           p.z >= box.low.z && p.z <= box.high.z;
}

void check_orientation(const Scene& scene, const Shape& shape, const Vec3f& eye,
                       Findings& findings) {
    constexpr std::size_t kMaxTriangles = 300'000;  // beyond, it would take seconds
    const Mesh* mesh = mesh_of(shape.geometry);
    if (!mesh || mesh->triangles.size() > kMaxTriangles) return;
    const MeshCheck check = check_mesh(*mesh, 1);
    if (20 * check.turned_normals > check.triangles)
        findings.push_back(
            fmt::format("shape '{}': {} of {} triangles face away from the normals of their "
                        "vertices",
                        shape.id, check.turned_normals, check.triangles));
    const bool shows_its_back = shape.material && scene[shape.material].back && !shape.emitter;
    if (!shows_its_back && !holds(box_of(shape.geometry), eye) && check.is_closed &&
        check.volume < 0)
        findings.push_back(fmt::format(
            "shape '{}' is closed and its normals point inwards: it is black from outside "
            "(flip_normals turns them)",
            shape.id));
}

/// Directions over the sphere, evenly.
Vec3f spiral(int i, int count) {
    const float z = 1 - (2 * static_cast<float>(i) + 1) / static_cast<float>(count);
    const float r = std::sqrt(1 - z * z), phi = 2.39996323f * static_cast<float>(i);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

constexpr int kRays = 128;

/// The shape that rays from a point into all directions, or into those above a normal, meet first,
/// if it is always the same side of the same one; -1: it is not.
std::int32_t surrounding_shape(const TracedScene& traced, const Vec3f& origin,
                               const Vec3f& normal) {
    const Accel& accel = traced.geometry->accel;
    std::int32_t shape = -1;
    bool behind = false;
    for (int i = 0; i < kRays; ++i) {
        const Vec3f direction = spiral(i, kRays);
        if (dot(direction, normal) < 0) continue;
        const Hit hit = first_hit(accel, origin, direction);
        if (hit.shape < 0 || (shape >= 0 && hit.shape != shape)) return -1;
        const Surface s =
            surface_at(*traced.scene, traced.geometry->triangles, hit, origin, direction);
        const bool is_back = dot(s.geometric_normal, direction) > 0;
        if (shape >= 0 && is_back != behind) return -1;
        shape = hit.shape, behind = is_back;
    }
    return shape;
}

/// A place from which an emitter shines, and which way: 0 is everywhere.
struct LightPlace {
    Vec3f position, normal;
};

/// The triangle in the middle of a mesh, or the next one whose normal is finite: one without area
/// has none. Null where all are like that.
const TriangleRecord* middle_triangle(std::span<const TriangleRecord> records) {
    for (std::size_t i = 0; i < records.size(); ++i) {
        const TriangleRecord& r = records[(records.size() / 2 + i) % records.size()];
        if (is_finite(r.geometric_normal)) return &r;
    }
    return nullptr;
}

Vec3f origin_of(const Transform& m) { return transform_point(m, {0, 0, 0}); }

std::optional<LightPlace> place_of(const TracedScene& traced, const Emitter& emitter) {
    return match(
        emitter,
        [&](const AreaEmitter& e) -> std::optional<LightPlace> {
            const TriangleRecord* const triangle = middle_triangle(
                traced.geometry->triangles[static_cast<std::size_t>(e.shape.value)]);
            if (!triangle) return {};  // a ball, which shines to all sides of itself
            const TriangleRecord& r = *triangle;
            const Vec3f middle = r.p0 + (r.edge1 + r.edge2) * (1.0f / 3);
            return LightPlace{leave_surface(middle, r.geometric_normal, r.geometric_normal),
                              r.geometric_normal};
        },
        [](const EnvironmentEmitter&) -> std::optional<LightPlace> { return {}; },
        [](const ConstantEmitter&) -> std::optional<LightPlace> { return {}; },
        [](const PointEmitter& e) -> std::optional<LightPlace> {
            return LightPlace{e.position, {}};
        },
        [](const SpotEmitter& e) -> std::optional<LightPlace> {
            return LightPlace{origin_of(e.to_world), {}};
        },
        [](const DirectionalEmitter&) -> std::optional<LightPlace> { return {}; },
        [](const ProjectorEmitter& e) -> std::optional<LightPlace> {
            return LightPlace{origin_of(e.to_world), {}};
        });
}

}  // namespace

void check_orientations(const TracedScene& traced, Findings& findings) {
    for (const Shape& shape : traced.scene->shapes)
        check_orientation(*traced.scene, shape, traced.camera.eye, findings);
}

void check_enclosed_lights(const TracedScene& traced, Findings& findings) {
    const Scene& scene = *traced.scene;
    const std::int32_t around_camera = surrounding_shape(traced, traced.camera.eye, {});
    for (std::size_t i = 0; i < scene.emitters.size(); ++i) {
        const auto place = place_of(traced, scene.emitters[i]);
        if (!place) continue;
        const std::int32_t around = surrounding_shape(traced, place->position, place->normal);
        if (around < 0 || around == around_camera) continue;
        const Shape& shape = scene.shapes[static_cast<std::size_t>(around)];
        const Material& material = scene[shape.material];
        if (shape.emitter.value == static_cast<std::int32_t>(i) || transmits(scene[material.front]))
            continue;
        findings.push_back(fmt::format(
            "{} lies inside of shape '{}', which lets no light through: it lights nothing else",
            label_of_emitter(scene, i), shape.id));
    }
}

}  // namespace burnish
