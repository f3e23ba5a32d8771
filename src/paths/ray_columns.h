// The rays of a batch, traced in packets of rays that point the same way.
#pragma once

#include "paths/accel.h"
#include "paths/columns.h"

namespace burnish {

struct RayColumns {
    ColumnVec3 origin, direction;  ///< world; direction is unit
    Column max_distance;           ///< along direction
};

/// Reorders a list of lanes so that rays in similar directions follow one another: packets of such
/// rays visit the same parts of the scene. The order depends on the rays of the list alone.
void sort_by_direction(const ColumnVec3& direction, ActiveList& list);

/// Sixteen rays; those from `live` on are dead.
RayPacket make_packet(const Vec3<Packet>& origin, const Vec3<Packet>& direction,
                      const Packet& max_distance, int live);

/// Sixteen rays of a list; lanes behind its end are dead.
RayPacket gather(const RayColumns& rays, const ColumnIndices& indices);

/// Takes the lanes whose ray meets anything before max_distance out of the list.
void keep_unoccluded(const Accel& accel, const RayColumns& rays, ActiveList& list);

}  // namespace burnish
