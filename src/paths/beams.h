// Lights that no ray can hit and that shine into a part of all directions, or from one alone: spot,
// projector, directional.
#pragma once

#include "paths/light_sample.h"
#include "paths/light_tree.h"
#include "scene/scene.h"

namespace burnish {

// The sample of such a light, seen from `position`: its pdf is 1, and its radiance includes
// 1 / distance^2 where it is near. Black where it does not shine.
LightSample sample_beam(const Scene& scene, const SpotEmitter& spot, const Vec3f& position);
LightSample sample_beam(const Scene& scene, const ProjectorEmitter& projector,
                        const Vec3f& position);
LightSample sample_beam(const DirectionalEmitter& light);

LightBounds beam_bounds(const Scene& scene, const SpotEmitter& spot);
LightBounds beam_bounds(const Scene& scene, const ProjectorEmitter& projector);

}  // namespace burnish
