#include "burnish/paths/lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace burnish {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

double triangle_area(const Mesh& mesh, const Triangle& t) {
    const auto at = [&](int i) {
        const Vec3f& p = mesh.positions[t.vertex[static_cast<std::size_t>(i)]];
        return Vec3<double>{p.x, p.y, p.z};
    };
    return 0.5 * length(cross(at(1) - at(0), at(2) - at(0)));
}

Lights::Area area_of(const Geometry& geometry) {
    Lights::Area result;
    if (const auto* mesh = std::get_if<Mesh>(&geometry)) {
        std::vector<double> areas;
        areas.reserve(mesh->triangles.size());
        double total = 0;
        for (const Triangle& t : mesh->triangles)
            total += areas.emplace_back(triangle_area(*mesh, t));
        result.triangles = make_alias_table(areas);
        result.area = static_cast<float>(total);
    } else if (const auto* sphere = std::get_if<Sphere>(&geometry)) {
        result.area = 4 * kPi * sphere->radius * sphere->radius;
    } else {
        const Transform& m = std::get<Disk>(geometry).to_world;
        const Vec3f x = transform_vector(m, {1, 0, 0}), y = transform_vector(m, {0, 1, 0});
        result.area = kPi * length(cross(x, y));
    }
    return result;
}

Vec3f uniform_direction(float u, float v) {
    const float z = 1 - 2 * u, r = std::sqrt(std::max(0.0f, 1 - z * z)), phi = 2 * kPi * v;
    return {r * std::cos(phi), r * std::sin(phi), z};
}

/// Completes an area sample: solid-angle density from the area density, black from behind. The
/// cosine is that of the shading normal, as in Mitsuba: on a mesh with interpolated normals the
/// density is not exactly that of the sampling, and a geometric cosine would not agree with its
/// images.
LightSample from_point(const SurfacePoint& point, const Rgbf& radiance, float pdf_area,
                       const Vec3f& origin) {
    const Vec3f to_light = point.position - origin;
    const float squared = length_squared(to_light), distance = std::sqrt(squared);
    LightSample sample;
    if (!(distance > 0)) return sample;
    sample.direction_world = to_light * (1 / distance);
    sample.distance = distance;
    const float cosine = -dot(sample.direction_world, point.shading_normal);
    if (!(cosine > 0)) return sample;
    sample.pdf = pdf_area * squared / cosine;
    sample.radiance = radiance;
    return sample;
}

LightSample sample_triangle(const TriangleRecord& triangle, float area, const Rgbf& radiance,
                            const Vec3f& origin, float u, float v) {
    const float root = std::sqrt(u);
    return from_point(triangle_point(triangle, 1 - root, v * root), radiance, 1 / area, origin);
}

/// 1 - cos of the half angle under which a sphere is seen, without cancellation for distant
/// spheres.
float cone_height(float sin_squared) {
    const float cosine = std::sqrt(std::max(0.0f, 1 - sin_squared));
    return sin_squared / (1 + cosine);
}

LightSample sample_sphere(const Sphere& sphere, float area, const Rgbf& radiance,
                          const Vec3f& origin, const std::array<float, 3>& u) {
    const Vec3f to_center = sphere.center - origin;
    const float squared = length_squared(to_center),
                sin_squared = sphere.radius * sphere.radius / squared;
    if (!(sin_squared < 0.9999f) ||
        sphere.flip_normals) {  // inside, on the surface, or lit from inside: by area
        const Vec3f outward = uniform_direction(u[0], u[1]);
        const Vec3f n = sphere.flip_normals ? -outward : outward;
        return from_point({sphere.center + outward * sphere.radius, n, n}, radiance, 1 / area,
                          origin);
    }
    const float height = cone_height(sin_squared);
    const float one_minus_cos = u[0] * height, cosine = 1 - one_minus_cos;
    const float sine = std::sqrt(std::max(0.0f, one_minus_cos * (2 - one_minus_cos)));
    const float phi = 2 * kPi * u[1], distance = std::sqrt(squared);
    const Frame axis = frame_from_normal(to_center * (1 / distance));
    LightSample sample;
    sample.direction_world = to_world(axis, {sine * std::cos(phi), sine * std::sin(phi), cosine});
    const float half =
        std::sqrt(std::max(0.0f, sphere.radius * sphere.radius - squared * sine * sine));
    sample.distance = distance * cosine - half;
    sample.radiance = radiance;
    sample.pdf = 1 / (2 * kPi * height);
    return sample;
}

LightSample sample_disk(const Disk& disk, float area, const Rgbf& radiance, const Vec3f& origin,
                        const std::array<float, 3>& u) {
    const float r = std::sqrt(u[0]), phi = 2 * kPi * u[1];
    const Vec3f n = transform_normal(disk.to_local, {0, 0, 1}), front = disk.flip_normals ? -n : n;
    return from_point(
        {transform_point(disk.to_world, {r * std::cos(phi), r * std::sin(phi), 0}), front, front},
        radiance, 1 / area, origin);
}

LightSample sample_area(const Lights& lights, const AreaEmitter& emitter, const LightChoice& choice,
                        const Vec3f& position) {
    const float area = lights.areas[choice.emitter].area;
    const auto& triangles = (*lights.triangles)[static_cast<std::size_t>(emitter.shape.value)];
    if (!triangles.empty())
        return sample_triangle(triangles[choice.triangle], area, emitter.radiance, position,
                               choice.u[2], choice.u[3]);
    const std::array<float, 3> u{choice.u[1], choice.u[2], choice.u[3]};
    const Geometry& geometry = (*lights.scene)[emitter.shape].geometry;
    if (const auto* sphere = std::get_if<Sphere>(&geometry))
        return sample_sphere(*sphere, area, emitter.radiance, position, u);
    return sample_disk(std::get<Disk>(geometry), area, emitter.radiance, position, u);
}

float pdf_area_emitter(const Lights& lights, const AreaEmitter& emitter, std::size_t index,
                       const Vec3f& origin, float distance, float cosine) {
    if (const auto* sphere = std::get_if<Sphere>(&(*lights.scene)[emitter.shape].geometry)) {
        const float sin_squared =
            sphere->radius * sphere->radius / length_squared(sphere->center - origin);
        if (sin_squared < 0.9999f && !sphere->flip_normals)
            return 1 / (2 * kPi * cone_height(sin_squared));
    }
    return distance * distance / (cosine * lights.areas[index].area);
}

}  // namespace

Lights build_lights(const Scene& scene, const TriangleTable& triangles) {
    Lights lights;
    lights.scene = &scene;
    lights.triangles = &triangles;
    lights.areas.resize(scene.emitters.size());
    for (std::size_t i = 0; i < scene.emitters.size(); ++i) {
        const Emitter& emitter = scene.emitters[i];
        if (const auto* area = std::get_if<AreaEmitter>(&emitter)) {
            lights.areas[i] = area_of(scene[area->shape].geometry);
        } else if (const auto* environment = std::get_if<EnvironmentEmitter>(&emitter)) {
            lights.environment = make_environment_table(*environment);
            lights.infinite = EmitterId{static_cast<std::int32_t>(i)};
        } else if (std::holds_alternative<ConstantEmitter>(emitter)) {
            lights.infinite = EmitterId{static_cast<std::int32_t>(i)};
        }
    }
    return lights;
}

LightChoice choose_light(const Lights& lights, const std::array<float, 4>& u) {
    const std::size_t emitters = lights.scene->emitters.size();
    const float scaled = u[0] * static_cast<float>(emitters);
    LightChoice choice;
    choice.emitter =
        static_cast<std::uint32_t>(std::min(static_cast<std::size_t>(scaled), emitters - 1));
    const float left = scaled - static_cast<float>(choice.emitter);
    choice.u = {std::clamp(left, 0.0f, 0x1.fffffep-1f), u[1], u[2], u[3]};
    const Lights::Area& area = lights.areas[choice.emitter];
    if (area.triangles.columns.empty()) return choice;
    choice.triangle = sample_alias_table(area.triangles, u[1]).index;
    const auto& emitter = std::get<AreaEmitter>(lights.scene->emitters[choice.emitter]);
    prefetch((*lights.triangles)[static_cast<std::size_t>(emitter.shape.value)][choice.triangle]);
    return choice;
}

LightSample sample_light(const Lights& lights, const LightChoice& choice, const Vec3f& position) {
    const auto& emitters = lights.scene->emitters;
    const Emitter& emitter = emitters[choice.emitter];
    LightSample sample;
    if (const auto* area = std::get_if<AreaEmitter>(&emitter)) {
        sample = sample_area(lights, *area, choice, position);
    } else if (std::holds_alternative<EnvironmentEmitter>(emitter)) {
        const EnvironmentSample e = sample_environment(*lights.environment, choice.u);
        sample = {e.direction_world, kInfinity, e.radiance, e.pdf, false};
    } else if (const auto* constant = std::get_if<ConstantEmitter>(&emitter)) {
        sample = {uniform_direction(choice.u[1], choice.u[2]), kInfinity, constant->radiance,
                  1 / (4 * kPi), false};
    } else {
        const auto& point = std::get<PointEmitter>(emitter);
        const Vec3f to_light = point.position - position;
        const float squared = length_squared(to_light), distance = std::sqrt(squared);
        if (distance > 0)
            sample = {to_light * (1 / distance), distance, point.intensity * (1 / squared), 1.0f,
                      true};
    }
    sample.pdf /= static_cast<float>(emitters.size());
    return sample;
}

EmissionSample emission_at_hit(const Lights& lights, const Hit& hit, const Vec3f& origin,
                               const Vec3f& direction) {
    const Scene& scene = *lights.scene;
    const EmitterId id = scene.shapes[static_cast<std::size_t>(hit.shape)].emitter;
    if (!id) return {};
    const auto& emitter = std::get<AreaEmitter>(scene[id]);
    const auto& triangles = (*lights.triangles)[static_cast<std::size_t>(hit.shape)];
    SurfacePoint point;
    if (!triangles.empty()) {
        point = triangle_point(triangles[static_cast<std::size_t>(hit.primitive)], hit.u, hit.v);
    } else {
        const Surface s = surface_at(scene, *lights.triangles, hit, origin, direction);
        point = {s.position, s.geometric_normal, s.shading.n};
    }
    const float cosine = -dot(direction, point.shading_normal);
    if (!(cosine > 0)) return {};
    const float pdf = pdf_area_emitter(lights, emitter, static_cast<std::size_t>(id.value), origin,
                                       hit.distance, cosine);
    return {emitter.radiance, pdf / static_cast<float>(scene.emitters.size())};
}

EmissionSample emission_at_infinity(const Lights& lights, const Vec3f& direction) {
    if (!lights.infinite) return {};
    const Emitter& emitter = (*lights.scene)[lights.infinite];
    const float choice = 1 / static_cast<float>(lights.scene->emitters.size());
    if (const auto* constant = std::get_if<ConstantEmitter>(&emitter))
        return {constant->radiance, choice / (4 * kPi)};
    const EnvironmentSample e = lookup_environment(*lights.environment, direction);
    return {e.radiance, choice * e.pdf};
}

}  // namespace burnish
