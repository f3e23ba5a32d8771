// Choosing a point of light as seen from a surface, and the density of that choice.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "burnish/core/alias_table.h"
#include "burnish/paths/surface.h"
#include "burnish/scene/scene.h"
#include "burnish/shading/environment.h"

namespace burnish {

/// What is needed to sample the emitters of a scene: built once. The scene must outlive it.
struct Lights {
    const Scene* scene = nullptr;
    const TriangleTable* triangles = nullptr;
    /// One record per emitter: every emitter is chosen with the same probability, as in Mitsuba.
    struct Area {
        AliasTable triangles;  ///< by area; empty for shapes that are not meshes
        float area = 0;        ///< world units squared
    };
    std::vector<Area> areas;  ///< parallel to scene->emitters; unused entries are empty
    std::optional<EnvironmentTable>
        environment;     ///< importance of the image; built where the scene has one
    EmitterId infinite;  ///< the environment or constant emitter, if any
};

/// Both must outlive the result.
Lights build_lights(const Scene& scene, const TriangleTable& triangles);

/// One draw of the emitter technique.
struct LightSample {
    Vec3f direction_world;  ///< unit, from the surface to the light
    float distance = 0;     ///< to the light; infinity for light from infinity
    Rgbf radiance;          ///< black where the draw failed (the light faces away)
    float pdf = 0;          ///< solid angle (at a light with interpolated normals measured by the
                            ///< shading normal, as in Mitsuba), choice of the emitter included; for
                            ///< a point light the probability of its choice
    bool delta =
        false;  ///< a point light: no other technique finds it; radiance is intensity / distance^2
};

/// The first half of a draw: which emitter, and which of its triangles. Its memory is asked for, so
/// that a batch of choices overlaps its waits.
struct LightChoice {
    std::uint32_t emitter = 0, triangle = 0;
    std::array<float, 4>
        u{};  ///< for the emitter: what its choice left, and the others; uniform again
};

/// u: four independent uniforms in [0, 1). The scene has at least one emitter.
LightChoice choose_light(const Lights& lights, const std::array<float, 4>& u);
/// The second half: the point on the chosen emitter, seen from a position.
LightSample sample_light(const Lights& lights, const LightChoice& choice, const Vec3f& position);

inline LightSample sample_light(const Lights& lights, const Vec3f& position,
                                const std::array<float, 4>& u) {
    return sample_light(lights, choose_light(lights, u), position);
}

/// Radiance that a ray which hit an emitting shape brings back, and the density with which
/// sample_light finds that direction from `origin`. Black from the back side.
struct EmissionSample {
    Rgbf radiance;
    float pdf = 0;
};
EmissionSample emission_at_hit(const Lights& lights, const Hit& hit, const Vec3f& origin,
                               const Vec3f& direction);
/// The same for a ray that left the scene.
EmissionSample emission_at_infinity(const Lights& lights, const Vec3f& direction);

}  // namespace burnish
