// The second half of a batch: from points, samples of light by both techniques, and the directions
// in which a path goes on.
//
// Where light does not go on from what a BSDF sample meets, only lights matter there. Such a sample
// is first traced against the shapes that emit, and then, like a light sample, tested for anything
// in between: a question with yes for an answer, which costs a fraction of finding the closest
// surface.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "paths/light_resampling.h"
#include "paths/points.h"

namespace burnish {

/// The samples of one technique; one lane per point.
struct SampleLanes {
    std::array<Column, 4> uniform;
    ColumnVec3 wo, f;  ///< local direction to the light or onwards; BSDF times cosine
    Column pdf;        ///< of the BSDF technique: solid angle, or the probability of a delta lobe
    Column eta;        ///< of the BSDF technique: SampledDirection::eta
    std::array<char, kMaxLanes> delta;  ///< of the BSDF technique; 0 without delta lobes
    RayColumns rays;                    ///< to the light, or onwards
    ColumnVec3 radiance_over_pdf;       ///< Le / (p_e + p_b) of those that arrived
    Column share;  ///< that a normal map leaves of the light, already in light samples' radiance
    /// What parts of blends multiply the light with, already in light samples' radiance; set where
    /// PointLanes::has_shares. Their f is multiplied with their share.
    ColumnVec3 part;
    ActiveList arrived;  ///< samples that carry light, or go on
};

/// 1 / density. NaN where that is not finite, so that the sample is counted and not taken for one
/// of no weight. T: float or Packet.
template <class T>
T inverse_density(const T& pdf) {
    constexpr float kMax = std::numeric_limits<float>::max();
    return select(pdf <= T(kMax), T(1.0f) / pdf, T(std::numeric_limits<float>::quiet_NaN()));
}

/// The stages' memory, reused from batch to batch.
struct ScatterWorkspace {
    std::vector<BsdfColumns> parameters;  ///< of each component of the mixture
    LightColumns light;
    LightCandidates candidates;
    SampleLanes samples;
};

PointBsdfs bsdfs_of(const TraceInput& input, const PointLanes& points, ScatterWorkspace& w);

/// bounce: how often light is scattered between the points and the camera; names the numbers, with
/// the sample.

/// Light samples of those points whose sample wants one. On return w.samples.arrived holds the
/// lanes that carry light if nothing lies on their ray, with wo, f and radiance_over_pdf.
void sample_emitters(const TraceInput& input, std::span<const BatchSample> samples,
                     const PointLanes& points, const PointBsdfs& bsdfs, std::uint32_t bounce,
                     ScatterWorkspace& w);

/// Keeps of `arrived` the samples whose rays meet nothing before their ends; sorted by direction.
void trace_shadow_rays(const TraceInput& input, SampleLanes& d);

/// BSDF samples of those points whose sample wants one. On return w.samples.arrived holds the lanes
/// whose ray can matter, in order, with wo, f, pdf, eta, delta and the ray.
void sample_bsdfs(const TraceInput& input, std::span<const BatchSample> samples,
                  const PointLanes& points, const PointBsdfs& bsdfs, std::uint32_t bounce,
                  ScatterWorkspace& w);

/// Multiplies radiance_over_pdf of the samples that arrived with what normal maps and parts of
/// blends leave of it.
void dim(const PointLanes& points, SampleLanes& d);

/// Keeps of the BSDF samples those that reach a light, and sets radiance_over_pdf, of which normal
/// maps leave `share`, and parts of blends `part`.
void find_emission(const TraceInput& input, const PointLanes& points, ScatterWorkspace& w);

/// Calls keep(lane) for each lane of `arrived`, in order of lanes.
template <class Keep>
void for_arrived(const SampleLanes& d, std::size_t count, const Keep& keep) {
    std::array<char, kMaxLanes> arrived{};
    for (std::size_t k = 0; k < d.arrived.count; ++k) arrived[d.arrived.lane[k]] = 1;
    for (std::size_t i = 0; i < count; ++i)
        if (arrived[i]) keep(i);
}

}  // namespace burnish
