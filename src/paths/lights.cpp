#include "paths/lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/variant.h"
#include "paths/light_bounds.h"

namespace burnish {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

AliasTable triangles_by_area(const Mesh& mesh) {
    std::vector<double> areas;
    areas.reserve(mesh.triangles.size());
    for (const Triangle& t : mesh.triangles) areas.push_back(triangle_area(mesh, t));
    return make_alias_table(areas);
}

Lights::Light area_light(const Scene& scene, const TriangleTable& triangles,
                         const AreaEmitter& emitter) {
    const Geometry& geometry = scene[emitter.shape].geometry;
    Lights::Light light;
    light.kind = match(
        geometry, [](const Mesh&) { return Lights::Kind::kMesh; },
        [](const Sphere&) { return Lights::Kind::kAnalytic; },
        [](const Disk&) { return Lights::Kind::kAnalytic; });
    light.radiance = emitter.radiance;
    light.area = static_cast<float>(area_of(geometry));
    light.triangles = triangles[static_cast<std::size_t>(emitter.shape.value)];
    if (const Mesh* mesh = mesh_of(geometry)) light.by_area = triangles_by_area(*mesh);
    return light;
}

/// A sample of the surface; no radiance where it faces away.
LightSample light_sample(const AreaSample<float>& s, const Rgbf& radiance) {
    return {s.direction_world, s.distance, s.pdf > 0 ? radiance : Rgbf{}, s.pdf, false};
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
        return light_sample(
            from_point<float>({sphere.center + outward * sphere.radius, n, n}, 1 / area, origin),
            radiance);
    }
    const float height = cone_height(sin_squared);
    const float one_minus_cos = u[0] * height, cosine = 1 - one_minus_cos;
    const float sine = std::sqrt(std::max(0.0f, one_minus_cos * (2 - one_minus_cos)));
    const SinCos<float> phi = sin_cos_turns(u[1]);
    const float distance = std::sqrt(squared);
    const Frame axis = frame_from_normal(to_center * (1 / distance));
    LightSample sample;
    sample.direction_world = to_world(axis, Vec3f{sine * phi.cos, sine * phi.sin, cosine});
    const float half =
        std::sqrt(std::max(0.0f, sphere.radius * sphere.radius - squared * sine * sine));
    sample.distance = distance * cosine - half;
    sample.radiance = radiance;
    sample.pdf = 1 / (2 * kPi * height);
    return sample;
}

LightSample sample_disk(const Disk& disk, float area, const Rgbf& radiance, const Vec3f& origin,
                        const std::array<float, 3>& u) {
    const float r = std::sqrt(u[0]);
    const SinCos<float> phi = sin_cos_turns(u[1]);
    const Vec3f n = transform_normal(disk.to_local, {0, 0, 1}), front = disk.flip_normals ? -n : n;
    const Vec3f position = transform_point(disk.to_world, {r * phi.cos, r * phi.sin, 0});
    return light_sample(from_point<float>({position, front, front}, 1 / area, origin), radiance);
}

LightSample sample_area(const Lights& lights, const AreaEmitter& emitter, const LightChoice& choice,
                        const Vec3f& position) {
    const Lights::Light& light = lights.lights[choice.emitter];
    const std::array<float, 3> u{choice.u[1], choice.u[2], choice.u[3]};
    return match(
        (*lights.scene)[emitter.shape].geometry,
        [&](const Mesh&) {
            const auto point = sample_triangle(light.triangles[choice.triangle], u[1], u[2]);
            return light_sample(from_point(point, 1 / light.area, position), light.radiance);
        },
        [&](const Sphere& sphere) {
            return sample_sphere(sphere, light.area, light.radiance, position, u);
        },
        [&](const Disk& disk) {
            return sample_disk(disk, light.area, light.radiance, position, u);
        });
}

LightSample sample_point(const PointEmitter& point, const Vec3f& position) {
    const Vec3f to_light = point.position - position;
    const float squared = length_squared(to_light), distance = std::sqrt(squared);
    if (!(distance > 0)) return {};
    return {to_light * (1 / distance), distance, point.intensity * (1 / squared), 1.0f, true};
}

/// Density of sample_sphere.
float pdf_sphere(const Sphere& sphere, const Vec3f& origin, float by_area) {
    const float sin_squared =
        sphere.radius * sphere.radius / length_squared(sphere.center - origin);
    if (!(sin_squared < 0.9999f) || sphere.flip_normals) return by_area;
    return 1 / (2 * kPi * cone_height(sin_squared));
}

float pdf_area_emitter(const Lights& lights, const AreaEmitter& emitter, std::size_t index,
                       const Vec3f& origin, float distance, float cosine) {
    const float by_area = distance * distance / (cosine * lights.lights[index].area);
    return match((*lights.scene)[emitter.shape].geometry, [&](const Mesh&) { return by_area; },
                 [&](const Sphere& sphere) { return pdf_sphere(sphere, origin, by_area); },
                 [&](const Disk&) { return by_area; });
}

EmitterSummary summarize(const Lights& lights) {
    const Scene& scene = *lights.scene;
    EmitterSummary summary;
    summary.count = lights.emitters->size();
    summary.middle = middle_of_lit_shapes(scene);
    for (std::uint32_t i = 0; i < summary.count; ++i) {
        const auto add_infinite = [&](float irradiance) {
            summary.infinite = i, summary.infinite_irradiance = irradiance;
        };
        const auto add_bounded = [&](const LightBounds& bounds) {
            summary.emitter.push_back(i);
            summary.bounds.push_back(bounds);
        };
        const Lights::Light& light = lights.lights[i];
        match((*lights.emitters)[i],
              [&](const AreaEmitter& e) {
                  add_bounded(area_light_bounds(scene[e.shape].geometry, light.triangles,
                                                light.radiance, light.area));
              },
              [&](const EnvironmentEmitter& e) { add_infinite(sky_irradiance(e)); },
              [&](const ConstantEmitter& e) { add_infinite(sky_irradiance(e)); },
              [&](const PointEmitter& e) { add_bounded(point_light_bounds(e)); });
    }
    return summary;
}

}  // namespace

Lights build_lights(const Scene& scene, const TriangleTable& triangles, LightSelection selection,
                    std::shared_ptr<const std::vector<Emitter>> emitters) {
    Lights lights;
    lights.scene = &scene;
    lights.triangles = &triangles;
    if (!emitters) emitters = {std::shared_ptr<const void>(), &scene.emitters};  // not owned
    lights.emitters = std::move(emitters);
    lights.of_shape.resize(scene.shapes.size());
    for (std::size_t i = 0; i < lights.emitters->size(); ++i) {
        const EmitterId id{static_cast<std::int32_t>(i)};
        lights.lights.push_back(
            match((*lights.emitters)[i],
                  [&](const AreaEmitter& e) {
                      lights.of_shape[static_cast<std::size_t>(e.shape.value)] = id;
                      return area_light(scene, triangles, e);
                  },
                  [&](const EnvironmentEmitter& e) {
                      lights.environment = make_environment_table(e);
                      lights.infinite = id;
                      return Lights::Light{Lights::Kind::kEnvironment, {}, 0, {}, {}};
                  },
                  [&](const ConstantEmitter& e) {
                      lights.infinite = id;
                      return Lights::Light{Lights::Kind::kConstant, e.radiance, 0, {}, {}};
                  },
                  [](const PointEmitter&) {
                      return Lights::Light{Lights::Kind::kPoint, {}, 0, {}, {}};
                  }));
    }
    lights.selector.emitters = static_cast<std::uint32_t>(lights.emitters->size());
    if (selection != LightSelection::kUniform)  // which needs to know no more of the scene
        lights.selector = build_light_selector(summarize(lights), selection);
    return lights;
}

LightChoice choose_light(const Lights& lights, const SelectedEmitter& selected,
                         const std::array<float, 4>& u) {
    LightChoice choice{
        selected.emitter, 0, selected.inverse_probability, {selected.rest, u[1], u[2], u[3]}};
    const Lights::Light& light = lights.lights[choice.emitter];
    if (light.kind != Lights::Kind::kMesh) return choice;
    choice.triangle = sample_alias_table(light.by_area, u[1]).index;
    prefetch(light.triangles[choice.triangle]);
    return choice;
}

LightSample sample_light(const Lights& lights, const LightChoice& choice, const Vec3f& position) {
    LightSample sample =
        match((*lights.emitters)[choice.emitter],
              [&](const AreaEmitter& e) { return sample_area(lights, e, choice, position); },
              [&](const EnvironmentEmitter&) {
                  const EnvironmentSample e = sample_environment(*lights.environment, choice.u);
                  return LightSample{e.direction_world, kInfinity, e.radiance, e.pdf, false};
              },
              [&](const ConstantEmitter& e) {
                  return LightSample{uniform_direction(choice.u[1], choice.u[2]), kInfinity,
                                     e.radiance, 1 / (4 * kPi), false};
              },
              [&](const PointEmitter& e) { return sample_point(e, position); });
    sample.pdf /= choice.inverse_probability;
    return sample;
}

EmissionSample emission_at_hit(const Lights& lights, const Hit& hit, const Vec3f& origin,
                               const Vec3f& direction) {
    const Scene& scene = *lights.scene;
    const EmitterId id = lights.of_shape[static_cast<std::size_t>(hit.shape)];
    if (!id) return {};
    const auto& emitter =
        std::get<AreaEmitter>((*lights.emitters)[static_cast<std::size_t>(id.value)]);
    const auto& triangles = (*lights.triangles)[static_cast<std::size_t>(hit.shape)];
    SurfacePoint<float> point;
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
    return {emitter.radiance, pdf / inverse_probability(lights.selector, origin,
                                                        static_cast<std::uint32_t>(id.value))};
}

template <class T>
EmissionOf<T> emission_at_infinity(const Lights& lights, const Vec3<T>& origin,
                                   const Vec3<T>& direction) {
    if (!lights.infinite) return {};
    const Lights::Light& light = lights.lights[static_cast<std::size_t>(lights.infinite.value)];
    const T choice = T(1.0f) / infinity_one_in(lights.selector, origin);
    switch (light.kind) {
        case Lights::Kind::kConstant:
            return {{T(light.radiance.x), T(light.radiance.y), T(light.radiance.z)},
                    choice / T(4 * kPi)};
        case Lights::Kind::kEnvironment: {
            const auto e = lookup_environment(*lights.environment, direction);
            return {e.radiance, choice * e.pdf};
        }
        case Lights::Kind::kMesh:
        case Lights::Kind::kAnalytic:
        case Lights::Kind::kPoint:
            break;  // not infinite
    }
    return {};
}

template EmissionSample emission_at_infinity(const Lights&, const Vec3f&, const Vec3f&);
template EmissionOf<Packet> emission_at_infinity(const Lights&, const Vec3<Packet>&,
                                                 const Vec3<Packet>&);

}  // namespace burnish
