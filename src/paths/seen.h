// What the rays of a batch see: the material of the surface that they meet, and the BSDF of the
// side.
#pragma once

#include "paths/layers.h"
#include "paths/ray_columns.h"
#include "paths/trace_input.h"

namespace burnish {

/// Rays of a batch and what they met; one lane per sample.
struct RayLanes {
    RayColumns rays;
    std::array<std::int32_t, kBatchSamples> shape, primitive;  ///< shape -1: nothing
    Column distance, u, v;
};

inline Hit hit_of(const RayLanes& r, std::size_t i) {
    return {r.shape[i], r.primitive[i], r.distance[i], r.u[i], r.v[i]};
}

inline void set_hit(RayLanes& r, std::size_t i, const Hit& hit) {
    r.shape[i] = hit.shape, r.primitive[i] = hit.primitive;
    r.distance[i] = hit.distance, r.u[i] = hit.u, r.v[i] = hit.v;
}

/// The surface that a ray has met.
Surface surface_of(const TracedScene& traced, const RayLanes& rays, std::size_t i);

inline LayeredPoint layered_point(const RayLanes& rays, std::size_t i, const Vec2f& uv) {
    return {get(rays.rays.origin, i), get(rays.rays.direction, i), uv};
}

/// Whether a BSDF, or a share of it, reads an unknown.
inline bool is_unknown(const TraceInput& input, BsdfId id) {
    return !input.unknown_bsdfs.empty() &&
           input.unknown_bsdfs[static_cast<std::size_t>(id.value)] != 0;
}

/// Whether a BSDF reads no unknown but those of its shares: then its value is part of the light.
inline bool has_unknown_share_alone(const TraceInput& input, BsdfId id) {
    return !input.unknown_bsdfs.empty() &&
           input.unknown_bsdfs[static_cast<std::size_t>(id.value)] == kUnknownShareAlone;
}

/// The BSDF of each sample whose surface is wanted, no BSDF for the others, and their materials.
struct SeenBsdfs {
    std::array<BsdfId, kBatchSamples> bsdf;
    std::array<ShownMaterial, kBatchSamples> shown;

    const BsdfId& operator[](std::size_t i) const { return bsdf[i]; }
};

/// Of the first `count` rays, on surfaces of input.choice.
SeenBsdfs seen_bsdfs(const TraceInput& input, std::size_t count, const RayLanes& rays);

}  // namespace burnish
