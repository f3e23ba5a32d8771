// Choosing a point of light as seen from a surface, and the density of that choice.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/alias_table.h"
#include "core/angle.h"
#include "core/random.h"
#include "paths/light_sample.h"
#include "paths/light_selection.h"
#include "paths/surface.h"
#include "scene/scene.h"
#include "shading/environment.h"

namespace burnish {

/// What is needed to sample emitters: built once. Scene and triangles must outlive it.
struct Lights {
    const Scene* scene = nullptr;
    const TriangleTable* triangles = nullptr;
    std::shared_ptr<const std::vector<Emitter>> emitters;  ///< those that are on
    std::vector<EmitterId> of_shape;  ///< the emitter of each shape of the scene, where it has one
    /// How a batch samples a light; which emitters and shapes are of which kind, build_lights says.
    /// kSingle: one sample at a time.
    enum class Kind { kMesh, kSingle, kEnvironment, kConstant };
    struct Light {
        Kind kind = Kind::kSingle;
        Rgbf radiance;       ///< of an area or constant emitter; without its texture
        float area = 0;      ///< of its shape, in world units squared
        AliasTable by_area;  ///< the triangles of a mesh
        std::span<const TriangleRecord> triangles;  ///< of a mesh
        TextureId texture = {};                     ///< of an area emitter
    };
    std::vector<Light> lights;                    ///< parallel to `emitters`
    std::optional<EnvironmentTable> environment;  ///< where there is one
    EmitterId infinite;  ///< the environment or constant emitter, if any; a scene has at most one
    LightSelector selector;
};

/// emitters: those that are on; empty: all of the scene. sky: as of make_environment_table.
Lights build_lights(const Scene& scene, const TriangleTable& triangles,
                    LightSelection selection = LightSelection::kUniform,
                    std::shared_ptr<const std::vector<Emitter>> emitters = {},
                    std::shared_ptr<const SkyTable> sky = {});

/// The first half of a light sample: which emitter, and which of its triangles. Its memory is asked
/// for, so that a batch of choices overlaps its waits.
struct LightChoice {
    std::uint32_t emitter = 0, triangle = 0;
    float inverse_probability = 1;  ///< 1 / probability of the emitter
    /// For the emitter: what its choice left, and the others; uniform again.
    std::array<float, 4> u{};
};

/// What the triangle of a mesh is chosen with: u[1], and for finer bits what the choice of the
/// emitter left of u[0].
inline double triangle_uniform(float u, float rest) { return fine_uniform(u, rest); }
/// Asks for the memory that choose_light reads: where many choose, each before the first of them.
void prefetch(const Lights& lights, const SelectedEmitter& selected, const std::array<float, 4>& u);
/// u: the uniforms that the emitter was selected with.
LightChoice choose_light(const Lights& lights, const SelectedEmitter& selected,
                         const std::array<float, 4>& u);
/// For a point at `position`. u: four independent uniforms in [0, 1). The scene has at least one
/// emitter. candidate: as of select_emitter.
inline LightChoice choose_light(const Lights& lights, const Vec3f& position,
                                const std::array<float, 4>& u, std::uint32_t candidate = 0) {
    return choose_light(lights, select_emitter(lights.selector, position, u, candidate), u);
}
/// The second half: the point on the chosen emitter, seen from the same position.
LightSample sample_light(const Lights& lights, const LightChoice& choice, const Vec3f& position);

inline LightSample sample_light(const Lights& lights, const Vec3f& position,
                                const std::array<float, 4>& u, std::uint32_t candidate = 0) {
    return sample_light(lights, choose_light(lights, position, u, candidate), position);
}

/// What a point of an emitting surface, chosen with an area density, sends to `origin`. T: float or
/// Packet.
template <class T>
struct AreaSample {
    Vec3<T> direction_world;  ///< unit
    T distance;
    T pdf;  ///< solid angle; 0 where the point faces away
};

/// The cosine is that of the shading normal, as in Mitsuba: on a mesh with interpolated normals the
/// density is not exactly that of the sampling, and a geometric cosine would not agree with its
/// images.
template <class T>
AreaSample<T> from_point(const SurfacePoint<T>& point, const T& pdf_area, const Vec3<T>& origin) {
    const T zero(0.0f), one(1.0f);
    const Vec3<T> to_light = point.position - origin;
    const T squared = length_squared(to_light), distance = sqrt(squared);
    const auto apart = distance > zero;
    const Vec3<T> direction = to_light * (one / select(apart, distance, one));
    const T cosine = -dot(direction, point.shading_normal);
    const auto lit = apart && cosine > zero;
    return {direction, distance, select(lit, pdf_area * squared / select(lit, cosine, one), zero)};
}

/// A point of a triangle, uniform in area: u, v uniform in [0, 1).
template <class T>
SurfacePoint<T> sample_triangle(const TriangleOf<T>& triangle, const T& u, const T& v) {
    const T root = sqrt(u);
    return triangle_point(triangle, T(T(1.0f) - root), T(v * root));
}

/// Its texture coordinate.
inline Vec2f sample_triangle_uv(const TriangleRecord& triangle, float u, float v) {
    const float root = std::sqrt(u);
    return triangle_uv(triangle, 1.0f - root, v * root);
}

/// Uniform on the sphere.
template <class T>
Vec3<T> uniform_direction(const T& u, const T& v) {
    const T z = T(1.0f) - T(2.0f) * u, r = safe_sqrt(T(T(1.0f) - z * z));
    const SinCos<T> phi = sin_cos_turns(v);
    return {r * phi.cos, r * phi.sin, z};
}

/// Radiance that a ray which hit an emitting shape brings back, and the density with which
/// sample_light finds that direction from `origin`. Black from the back side.
template <class T>
struct EmissionOf {
    Rgb<T> radiance;
    T pdf{};
};
using EmissionSample = EmissionOf<float>;
EmissionSample emission_at_hit(const Lights& lights, const Hit& hit, const Vec3f& origin,
                               const Vec3f& direction);
/// The same for a ray from `origin` that left the scene. T: float or Packet.
template <class T>
EmissionOf<T> emission_at_infinity(const Lights& lights, const Vec3<T>& origin,
                                   const Vec3<T>& direction);

}  // namespace burnish
