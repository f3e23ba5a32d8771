// What looks wrong in space: surfaces that are inside out, lights that are walled in.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

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

/// Whether light is refracted into it.
bool is_glass(const Bsdf& bsdf) { return transmits(bsdf) && !is_sheet(bsdf); }

bool holds_glass(const Scene& scene, MaterialId material) {
    return std::ranges::any_of(shown_parts(scene, material),
                               [&](MaterialId part) { return is_glass(scene[scene[part].front]); });
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
    if (holds(box_of(shape.geometry), eye) || !check.is_closed || check.volume >= 0) return;
    const auto add = [&](const char* what) {
        findings.push_back(fmt::format(
            "shape '{}' is closed and its normals point inwards: {} (flip_normals turns them)",
            shape.id, what));
    };
    if (shape.emitter || has_black_back(scene, shape.material))
        add("it is black from outside");
    else if (holds_glass(scene, shape.material))
        add("inside and outside of its glass are exchanged, unless it is a hollow in it");
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

/// Of the triangles of a mesh, evenly spread: a lamp may be stuck into a surface in part. One
/// without area has no normal and is left out.
std::vector<LightPlace> places_on(std::span<const TriangleRecord> records) {
    constexpr std::size_t kMax = 16;
    std::vector<LightPlace> all, some;
    for (const TriangleRecord& r : records) {
        if (!is_finite(r.geometric_normal)) continue;
        const Vec3f middle = r.p0 + (r.edge1 + r.edge2) * (1.0f / 3);
        all.push_back(
            {leave_surface(middle, r.geometric_normal, r.geometric_normal), r.geometric_normal});
    }
    const std::size_t count = std::min(kMax, all.size());
    for (std::size_t i = 0; i < count; ++i) some.push_back(all[i * all.size() / count]);
    return some;
}

Vec3f origin_of(const Transform& m) { return transform_point(m, {0, 0, 0}); }

/// Empty where it has none, as a sky, or shines to all sides of itself, as a ball.
std::vector<LightPlace> places_of(const TracedScene& traced, const Emitter& emitter) {
    using Places = std::vector<LightPlace>;
    return match(
        emitter,
        [&](const AreaEmitter& e) {
            return places_on(traced.geometry->triangles[static_cast<std::size_t>(e.shape.value)]);
        },
        [](const EnvironmentEmitter&) { return Places{}; },
        [](const ConstantEmitter&) { return Places{}; },
        [](const PointEmitter& e) {
            return Places{{e.position, {}}};
        },
        [](const SpotEmitter& e) {
            return Places{{origin_of(e.to_world), {}}};
        },
        [](const DirectionalEmitter&) { return Places{}; },
        [](const ProjectorEmitter& e) {
            return Places{{origin_of(e.to_world), {}}};
        });
}

/// That surrounds all places; -1: there is none.
std::int32_t surrounding_shape(const TracedScene& traced, std::span<const LightPlace> places) {
    std::int32_t shape = -1;
    for (const LightPlace& p : places) {
        const std::int32_t around = surrounding_shape(traced, p.position, p.normal);
        if (around < 0 || (shape >= 0 && around != shape)) return -1;
        shape = around;
    }
    return shape;
}

}  // namespace

void check_orientations(const TracedScene& traced, Findings& findings) {
    for (const Shape& shape : traced.scene->shapes)
        check_orientation(*traced.scene, shape, traced.camera.eye, findings);
}

void check_places(const Scene& scene, Findings& findings) {
    for (const Shape& shape : scene.shapes) {
        if (!has_parameter(scene, shape.material)) continue;
        if (const std::string text = complaint_of_place(box_of(shape.geometry)); !text.empty())
            findings.push_back(fmt::format("shape '{}' {}", shape.id, text));
    }
}

void check_enclosed_lights(const TracedScene& traced, Findings& findings) {
    const Scene& scene = *traced.scene;
    const std::int32_t around_camera = surrounding_shape(traced, traced.camera.eye, {});
    for (std::size_t i = 0; i < scene.emitters.size(); ++i) {
        const std::int32_t around = surrounding_shape(traced, places_of(traced, scene.emitters[i]));
        if (around < 0 || around == around_camera) continue;
        const Shape& shape = scene.shapes[static_cast<std::size_t>(around)];
        const bool lets_light_through = std::ranges::any_of(
            shown_parts(scene, shape.material),
            [&](MaterialId part) { return transmits(scene[scene[part].front]); });
        if (shape.emitter.value == static_cast<std::int32_t>(i) || lets_light_through) continue;
        findings.push_back(fmt::format(
            "{} lies inside of shape '{}', which lets no light through: it lights nothing else",
            label_of_emitter(scene, i), shape.id));
    }
}

}  // namespace burnish
