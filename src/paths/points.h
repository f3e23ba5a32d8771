// The points at the ends of a batch's rays that scatter light.
#pragma once

#include "paths/bsdf_columns.h"
#include "paths/seen.h"

namespace burnish {

/// The points of a batch that scatter light back along its rays, sorted by kind of BSDF and BSDF.
/// Each kind fills whole packets: behind its points come copies of its last one, which are not
/// live.
struct PointLanes {
    std::size_t count = 0;  ///< lanes in use, padding included
    LanesOfKinds kinds;
    ActiveList live;  ///< points that can be lit as seen from the ray; in order of lanes
    std::array<std::uint16_t, kMaxLanes> sample;  ///< index into the batch
    std::array<BsdfId, kMaxLanes> bsdf;           ///< of the side that the ray meets
    std::array<char, kMaxLanes> has_unknowns;     ///< its BSDF, or a share of it, reads an unknown
    ColumnVec3 position, geometric_normal, s, t, n;
    Column u, v;
    ColumnVec3 wi;  ///< back along the ray, local
    Column side;    ///< -1: a two-sided material seen from behind; local z is mirrored
    std::array<MaterialId, kMaxLanes> material;  ///< that is shown
    bool has_shares = false;  ///< some points are parts of blends whose chance is not 1
    Column share, chance;     ///< as of ShownMaterial; set where some have
    bool has_turned = false;  ///< some normals are turned by a map
    ColumnVec3 old_normal;    ///< before it was turned, where the material says so
};

/// What a normal map leaves of the light to or from a direction at a point; 1 without one.
inline float share_of_light(const Scene& scene, const PointLanes& points, std::size_t i,
                            const Vec3f& direction_world) {
    const auto& normals = scene[points.material[i]].normals;
    if (!normals) return 1;
    return share_of_light(*normals, get(points.old_normal, i), get(points.n, i), direction_world);
}

/// The points that the first `count` rays met, on surfaces of input.choice.
void find_points(const TraceInput& input, std::size_t count, const RayLanes& rays,
                 PointLanes& points);

inline FrameOf<Packet> load_frame(const PointLanes& p, std::size_t i) {
    return {load(p.s, i), load(p.t, i), load(p.n, i)};
}

/// Four uniforms for each lane, which sample, technique and bounce name.
void draw_uniforms(const TraceInput& input, std::span<const BatchSample> samples,
                   const PointLanes& points, Technique technique, std::uint32_t bounce,
                   std::array<Column, 4>& u);
/// A fifth one of the light sample.
void draw_choice(const TraceInput& input, std::span<const BatchSample> samples,
                 const PointLanes& points, std::uint32_t bounce, Column& u);

/// Between the world and the frame of the side that the ray meets.
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
