// The first half of a batch: primary rays, and the surfaces that scatter at their ends.
#pragma once

#include "paths/bsdf_columns.h"
#include "paths/ray_columns.h"
#include "paths/trace_input.h"

namespace burnish {

/// The primary rays of a batch and what they met; one lane per sample.
struct PrimaryLanes {
    std::array<std::uint32_t, kBatchSamples> film_pass;
    Column film_x, film_y;  ///< as fractions of the whole film
    RayColumns rays;
    std::array<std::int32_t, kBatchSamples> shape, primitive;
    Column distance, u, v;
};

/// The points of a batch that scatter light to the camera, sorted by kind of BSDF and BSDF. Each
/// kind fills whole packets: behind its points come copies of its last one, which are not live.
struct PointLanes {
    std::size_t count = 0;  ///< lanes in use, padding included
    LanesOfKinds kinds;
    ActiveList live;  ///< points that can be lit from where the camera is; in order of lanes
    std::array<std::uint16_t, kMaxLanes> sample;  ///< index into the batch
    std::array<BsdfId, kMaxLanes> bsdf;           ///< of the side that the camera sees
    std::array<char, kMaxLanes> has_unknowns;     ///< its BSDF reads an unknown
    ColumnVec3 position, geometric_normal, s, t, n;
    Column u, v;
    ColumnVec3 wi;  ///< to the camera, local
    Column side;    ///< -1: a two-sided material seen from behind; local z is mirrored
};

/// Traces the primary rays of a batch. emitted[i] is set to what sample i sees of the lights
/// directly.
void trace_points(const TraceInput& input, std::span<const BatchSample> samples,
                  PrimaryLanes& primary, PointLanes& points, std::span<Rgbf> emitted);

/// Of each sample of a batch, in the first channel, 1 where it meets a surface or sees an
/// environment, else 0; in the second 1.
void trace_coverage(const TraceInput& input, std::span<const BatchSample> samples,
                    std::span<Rgbf> seen);

inline FrameOf<Packet> load_frame(const PointLanes& p, std::size_t i) {
    return {load(p.s, i), load(p.t, i), load(p.n, i)};
}

/// Between the world and the frame of the side that the camera sees.
inline Vec3<Packet> direction_to_local(const PointLanes& p, std::size_t i,
                                       const Vec3<Packet>& world) {
    Vec3<Packet> local = to_local(load_frame(p, i), world);
    local.z = local.z * load(p.side, i);
    return local;
}
inline Vec3<Packet> direction_to_world(const PointLanes& p, std::size_t i, Vec3<Packet> local) {
    local.z = local.z * load(p.side, i);
    return to_world(load_frame(p, i), local);
}

}  // namespace burnish
