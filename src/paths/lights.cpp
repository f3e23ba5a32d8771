#include "paths/lights.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/variant.h"
#include "paths/beams.h"
#include "paths/light_bounds.h"
#include "shading/texture_packet.h"

namespace burnish {

namespace {

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
    const Mesh* const mesh = mesh_of(geometry);
    light.kind = mesh && !emitter.texture ? Lights::Kind::kMesh : Lights::Kind::kSingle;
    light.radiance = emitter.radiance;
    light.texture = emitter.texture;
    light.area = static_cast<float>(area_of(geometry));
    light.triangles = triangles[static_cast<std::size_t>(emitter.shape.value)];
    if (mesh) light.by_area = triangles_by_area(*mesh);
    return light;
}

/// What a light sends out at a texture coordinate.
Rgbf textured(const Lights& lights, const Lights::Light& light, const Vec2f& uv) {
    if (!light.texture) return light.radiance;
    return light.radiance *
           eval_texture(TextureTable{lights.scene->textures, {}}, light.texture, uv);
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

/// sin^2 of the half angle under which a sphere is seen, where its cone is sampled; none where its
/// area is: seen from inside or from the surface, or lit from inside.
std::optional<float> sampled_cone(const Sphere& sphere, const Vec3f& origin) {
    const float sin_squared =
        sphere.radius * sphere.radius / length_squared(sphere.center - origin);
    if (!(sin_squared < 0.9999f) || sphere.flip_normals) return {};
    return sin_squared;
}

LightSample sample_sphere(const Sphere& sphere, float area, const Rgbf& radiance,
                          const Vec3f& origin, const std::array<float, 3>& u) {
    const std::optional<float> sin_squared = sampled_cone(sphere, origin);
    if (!sin_squared) {
        const Vec3f outward = uniform_direction(u[0], u[1]);
        const Vec3f n = sphere.flip_normals ? -outward : outward;
        return light_sample(
            from_point<float>({sphere.center + outward * sphere.radius, n, n}, 1 / area, origin),
            radiance);
    }
    const Vec3f to_center = sphere.center - origin;
    const float squared = length_squared(to_center), height = cone_height(*sin_squared);
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

LightSample sample_cylinder(const Cylinder& cylinder, float area, const Rgbf& radiance,
                            const Vec3f& origin, const std::array<float, 3>& u) {
    const SinCos<float> phi = sin_cos_turns(u[1]);
    const Vec3f local{phi.cos, phi.sin, 0};
    const Vec3f outward = transform_normal(cylinder.to_local, local),
                front = cylinder.flip_normals ? -outward : outward;
    const Vec3f position = transform_point(cylinder.to_world, {local.x, local.y, u[0]});
    return light_sample(from_point<float>({position, front, front}, 1 / area, origin), radiance);
}

/// The surface that a sample of a shape was drawn on, for its texture.
Vec2f uv_of_sample(const Lights& lights, std::size_t shape, const LightSample& s,
                   const Vec3f& position) {
    const Hit hit{static_cast<std::int32_t>(shape), 0, s.distance, 0, 0};
    return surface_at(*lights.scene, *lights.triangles, hit, position, s.direction_world).uv;
}

LightSample sample_shape(const Lights& lights, const AreaEmitter& emitter,
                         const LightChoice& choice, const Vec3f& position) {
    const Lights::Light& light = lights.lights[choice.emitter];
    const std::array<float, 3> u{choice.u[1], choice.u[2], choice.u[3]};
    return match((*lights.scene)[emitter.shape].geometry,
                 [&](const Mesh&) {
                     const TriangleRecord& triangle = light.triangles[choice.triangle];
                     const auto point = sample_triangle(triangle, u[1], u[2]);
                     const Rgbf radiance =
                         textured(lights, light, sample_triangle_uv(triangle, u[1], u[2]));
                     return light_sample(from_point(point, 1 / light.area, position), radiance);
                 },
                 [&](const Sphere& sphere) {
                     return sample_sphere(sphere, light.area, light.radiance, position, u);
                 },
                 [&](const Disk& disk) {
                     return sample_disk(disk, light.area, light.radiance, position, u);
                 },
                 [&](const Cylinder& cylinder) {
                     return sample_cylinder(cylinder, light.area, light.radiance, position, u);
                 },
                 [](const Instance&) { return LightSample{}; });  // does not emit
}

LightSample sample_area(const Lights& lights, const AreaEmitter& emitter, const LightChoice& choice,
                        const Vec3f& position) {
    LightSample s = sample_shape(lights, emitter, choice, position);
    const Lights::Light& light = lights.lights[choice.emitter];
    if (!light.texture || !light.triangles.empty() || is_black(s.radiance)) return s;
    const auto shape = static_cast<std::size_t>(emitter.shape.value);
    s.radiance = textured(lights, light, uv_of_sample(lights, shape, s, position));
    return s;
}

LightSample sample_point(const PointEmitter& point, const Vec3f& position) {
    const Vec3f to_light = point.position - position;
    const float squared = length_squared(to_light), distance = std::sqrt(squared);
    if (!(distance > 0)) return {};
    return {to_light * (1 / distance), distance, point.intensity * (1 / squared), 1.0f, true};
}

/// Density of sample_sphere.
float pdf_sphere(const Sphere& sphere, const Vec3f& origin, float by_area) {
    const std::optional<float> sin_squared = sampled_cone(sphere, origin);
    return sin_squared ? 1 / (2 * kPi * cone_height(*sin_squared)) : by_area;
}

float pdf_area_emitter(const Lights& lights, const AreaEmitter& emitter, std::size_t index,
                       const Vec3f& origin, float distance, float cosine) {
    const float by_area = distance * distance / (cosine * lights.lights[index].area);
    return match((*lights.scene)[emitter.shape].geometry, [&](const Mesh&) { return by_area; },
                 [&](const Sphere& sphere) { return pdf_sphere(sphere, origin, by_area); },
                 [&](const Disk&) { return by_area; }, [&](const Cylinder&) { return by_area; },
                 [](const Instance&) { return 0.0f; });
}

EmitterSummary summarize(const Lights& lights) {
    const Scene& scene = *lights.scene;
    EmitterSummary summary;
    summary.count = lights.emitters->size();
    summary.middle = middle_of_lit_shapes(scene);
    summary.sky = lights.infinite.value;
    for (std::uint32_t i = 0; i < summary.count; ++i) {
        const auto add_infinite = [&](float irradiance) {
            summary.infinite.push_back({i, irradiance});
        };
        const auto add_bounded = [&](const LightBounds& bounds) {
            summary.emitter.push_back(i);
            summary.bounds.push_back(bounds);
        };
        const Lights::Light& light = lights.lights[i];
        match((*lights.emitters)[i],
              [&](const AreaEmitter& e) {
                  add_bounded(area_light_bounds(scene[e.shape].geometry, light.triangles,
                                                mean_radiance(scene, e), light.area));
              },
              [&](const EnvironmentEmitter& e) { add_infinite(sky_irradiance(e)); },
              [&](const ConstantEmitter& e) { add_infinite(sky_irradiance(e)); },
              [&](const PointEmitter& e) { add_bounded(point_light_bounds(e)); },
              [&](const SpotEmitter& e) { add_bounded(beam_bounds(scene, e)); },
              [&](const DirectionalEmitter& e) {
                  add_infinite(luminance_of_magnitude(e.irradiance));
              },
              [&](const ProjectorEmitter& e) { add_bounded(beam_bounds(scene, e)); });
    }
    return summary;
}

}  // namespace

Lights build_lights(const Scene& scene, const TriangleTable& triangles, LightSelection selection,
                    std::shared_ptr<const std::vector<Emitter>> emitters,
                    std::shared_ptr<const SkyTable> sky) {
    Lights lights;
    lights.scene = &scene;
    lights.triangles = &triangles;
    if (!emitters) emitters = {std::shared_ptr<const void>(), &scene.emitters};  // not owned
    lights.emitters = std::move(emitters);
    lights.of_shape.resize(scene.shapes.size());
    for (std::size_t i = 0; i < lights.emitters->size(); ++i) {
        const EmitterId id{static_cast<std::int32_t>(i)};
        const auto single = [](const auto&) {
            return Lights::Light{Lights::Kind::kSingle, {}, 0, {}, {}};
        };
        lights.lights.push_back(
            match((*lights.emitters)[i],
                  [&](const AreaEmitter& e) {
                      lights.of_shape[static_cast<std::size_t>(e.shape.value)] = id;
                      return area_light(scene, triangles, e);
                  },
                  [&](const EnvironmentEmitter& e) {
                      lights.environment = make_environment_table(e, sky);
                      lights.infinite = id;
                      return Lights::Light{Lights::Kind::kEnvironment, {}, 0, {}, {}};
                  },
                  [&](const ConstantEmitter& e) {
                      lights.infinite = id;
                      return Lights::Light{Lights::Kind::kConstant, e.radiance, 0, {}, {}};
                  },
                  [&](const PointEmitter& e) { return single(e); },
                  [&](const SpotEmitter& e) { return single(e); },
                  [&](const DirectionalEmitter& e) { return single(e); },
                  [&](const ProjectorEmitter& e) { return single(e); }));
    }
    lights.selector.selection = selection;
    lights.selector.emitters = static_cast<std::uint32_t>(lights.emitters->size());
    const bool by_number =
        selection == LightSelection::kUniform || has_candidate_of_each(lights.selector);
    if (!by_number)  // else it needs to know no more of the scene
        lights.selector = build_light_selector(summarize(lights), selection);
    return lights;
}

void prefetch(const Lights& lights, const SelectedEmitter& selected,
              const std::array<float, 4>& u) {
    const AliasTable& table = lights.lights[selected.emitter].by_area;
    if (!table.columns.empty())
        __builtin_prefetch(
            &table.columns[alias_column(table, triangle_uniform(u[1], selected.rest))]);
}

LightChoice choose_light(const Lights& lights, const SelectedEmitter& selected,
                         const std::array<float, 4>& u) {
    LightChoice choice{
        selected.emitter, 0, selected.inverse_probability, {selected.rest, u[1], u[2], u[3]}};
    const Lights::Light& light = lights.lights[choice.emitter];
    if (light.triangles.empty()) return choice;
    choice.triangle =
        sample_alias_table(light.by_area, triangle_uniform(u[1], selected.rest)).index;
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
              [&](const PointEmitter& e) { return sample_point(e, position); },
              [&](const SpotEmitter& e) { return sample_beam(*lights.scene, e, position); },
              [&](const DirectionalEmitter& e) { return sample_beam(e); },
              [&](const ProjectorEmitter& e) { return sample_beam(*lights.scene, e, position); });
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
    const Lights::Light& light = lights.lights[static_cast<std::size_t>(id.value)];
    SurfacePoint<float> point;
    Rgbf radiance = light.radiance;
    if (!triangles.empty() && !light.texture) {
        point = triangle_point(triangles[static_cast<std::size_t>(hit.primitive)], hit.u, hit.v);
    } else {
        const Surface s = surface_at(scene, *lights.triangles, hit, origin, direction);
        point = {s.position, s.geometric_normal, s.shading.n};
        radiance = textured(lights, light, s.uv);
    }
    const float cosine = -dot(direction, point.shading_normal);
    if (!(cosine > 0)) return {};
    const float pdf = pdf_area_emitter(lights, emitter, static_cast<std::size_t>(id.value), origin,
                                       hit.distance, cosine);
    return {radiance, pdf / inverse_probability(lights.selector, origin,
                                                static_cast<std::uint32_t>(id.value))};
}

template <class T>
EmissionOf<T> emission_at_infinity(const Lights& lights, const Vec3<T>& origin,
                                   const Vec3<T>& direction) {
    if (!lights.infinite) return {};
    const Lights::Light& light = lights.lights[static_cast<std::size_t>(lights.infinite.value)];
    const T choice = T(1.0f) / inverse_probability_at_infinity(lights.selector, origin);
    switch (light.kind) {
        case Lights::Kind::kConstant:
            return {{T(light.radiance.x), T(light.radiance.y), T(light.radiance.z)},
                    choice / T(4 * kPi)};
        case Lights::Kind::kEnvironment: {
            const auto e = lookup_environment(*lights.environment, direction);
            return {e.radiance, choice * e.pdf};
        }
        case Lights::Kind::kMesh:
        case Lights::Kind::kSingle:
            break;  // not infinite
    }
    return {};
}

template EmissionSample emission_at_infinity(const Lights&, const Vec3f&, const Vec3f&);
template EmissionOf<Packet> emission_at_infinity(const Lights&, const Vec3<Packet>&,
                                                 const Vec3<Packet>&);

}  // namespace burnish
