// The emitter technique for a batch: what sample_light of lights.h draws, sixteen points at a time.
#pragma once

#include "paths/columns.h"
#include "paths/lights.h"

namespace burnish {

/// LightSample per lane.
struct LightColumns {
    ColumnVec3 direction_world;
    Column distance;
    ColumnVec3 radiance;
    Column pdf;
    Column delta;  ///< 1 for a light that no ray hits, else 0
};

/// A sample for each lane of `wanted`, lane by lane the bits of sample_light. u: four uniforms per
/// lane. candidate: see select_emitter. All other lanes below `count` get pdf 0.
void sample_lights(const Lights& lights, const std::array<Column, 4>& u, const ColumnVec3& position,
                   const ActiveList& wanted, std::size_t count, std::uint32_t candidate,
                   LightColumns& out);

/// emission_at_infinity along the directions of a list of lanes.
void emission_at_infinity(const Lights& lights, const ColumnVec3& origin,
                          const ColumnVec3& direction_world, const ActiveList& list,
                          ColumnVec3& radiance, Column& pdf);

}  // namespace burnish
