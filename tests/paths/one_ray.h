// Single rays through the packet interface, for tests.
#pragma once

#include <limits>

#include "paths/trace.h"

namespace burnish::test {

inline RayPacket packet_of(const Vec3f& origin, const Vec3f& direction, float max_distance) {
    RayPacket packet;
    packet.valid.fill(0);
    packet.valid[0] = -1;
    for (auto* a : {&packet.origin_x, &packet.origin_y, &packet.origin_z, &packet.direction_x,
                    &packet.direction_y, &packet.direction_z, &packet.max_distance})
        a->fill(0);
    packet.origin_x[0] = origin.x, packet.origin_y[0] = origin.y, packet.origin_z[0] = origin.z;
    packet.direction_x[0] = direction.x, packet.direction_y[0] = direction.y;
    packet.direction_z[0] = direction.z, packet.max_distance[0] = max_distance;
    return packet;
}

inline Hit first_hit(const Accel& accel, const Vec3f& origin, const Vec3f& direction,
                     float max_distance = std::numeric_limits<float>::infinity()) {
    const HitPacket h =
        accel.intersect(packet_of(origin, direction, max_distance), Coherence::kIncoherent);
    return {h.shape[0], h.primitive[0], h.distance[0], h.u[0], h.v[0]};
}

inline bool is_occluded(const Accel& accel, const Vec3f& origin, const Vec3f& direction,
                        float max_distance) {
    return accel.occluded(packet_of(origin, direction, max_distance), Coherence::kIncoherent)[0] !=
           0;
}

}  // namespace burnish::test
