// The rays of a batch, traced in packets of rays that point the same way.
#pragma once

#include "burnish/paths/accel.h"
#include "burnish/paths/lanes.h"

namespace burnish {

struct RayLanes {
    LaneVec3 origin, direction;  ///< world; direction is unit
    Lane max_distance;           ///< along direction
};

/// Reorders a list of lanes so that rays in similar directions follow one another: packets of such
/// rays visit the same parts of the scene. The order depends on the rays of the list alone.
void sort_by_direction(const LaneVec3& direction, LaneList& list);

/// Sixteen rays; those from `live` on are dead.
RayPacket make_packet(const Vec3<Packet>& origin, const Vec3<Packet>& direction,
                      const Packet& max_distance, int live);

/// Sixteen rays of a list; lanes behind its end are dead.
RayPacket gather(const RayLanes& rays, const LaneIndices& indices);

/// Takes the lanes whose ray meets anything before max_distance out of the list.
void keep_unoccluded(const Accel& accel, const RayLanes& rays, LaneList& list);

}  // namespace burnish
