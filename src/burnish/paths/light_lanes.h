// The emitter technique for a batch: what sample_light of lights.h draws, sixteen points at a time.
#pragma once

#include "burnish/paths/lanes.h"
#include "burnish/paths/lights.h"

namespace burnish {

/// LightSample per lane.
struct LightLanes {
    LaneVec3 direction_world;
    Lane distance;
    LaneVec3 radiance;
    Lane pdf;
    Lane delta;  ///< 1 for a point light, else 0
};

/// A draw for each lane of `wanted`, lane by lane the bits of sample_light. u: four uniforms per
/// lane. All other lanes below `count` get pdf 0.
void sample_lights(const Lights& lights, const std::array<Lane, 4>& u, const LaneVec3& position,
                   const LaneList& wanted, std::size_t count, LightLanes& out);

/// emission_at_infinity along the directions of a list of lanes.
void emission_at_infinity(const Lights& lights, const LaneVec3& origin,
                          const LaneVec3& direction_world, const LaneList& list, LaneVec3& radiance,
                          Lane& pdf);

}  // namespace burnish
