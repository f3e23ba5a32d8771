// Which of its candidates a light sample is: resampled importance sampling [RIS].
//
// Candidate c is a point y_c on a light. One of M candidates is taken, with the probability
//
//     P_c = (1 - e) w_c / (w_1 + ... + w_M) + e / M,
//     w_c = luminance of f(y_c) Le(y_c) / (p_e(y_c) + p_b(y_c)),
//
// and counts f Le / (p_e + p_b) / P_c. p_e is the sum of the candidates' densities, so that in
// expectation over the choice M techniques and the BSDF's are weighed by the balance heuristic.
// What hides a light is not asked; e bounds what a sample may come to weigh as textures move.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "paths/bsdf_mixture.h"
#include "paths/light_columns.h"
#include "paths/points.h"

namespace burnish {

struct CandidateChoice {
    std::uint32_t candidate = 0;
    float inverse_probability = 1;
};
/// weights: of the candidates, at least one. u: uniform in [0, 1). Uniformly where all are 0.
CandidateChoice choose_candidate(std::span<const float> weights, float u);

/// Luminance of f Le / (p_e + p_b); 0 where that is not a positive number. T: float or Packet.
template <class T>
T candidate_weight(const Rgb<T>& f, const Rgb<T>& radiance, const T& density) {
    const T weight = luminance(f * radiance) / density, zero(0.0f);
    return select(weight > zero && weight <= T(std::numeric_limits<float>::max()), weight, zero);
}

/// What BSDFs make of light samples. wo: local direction to the light; f: BSDF times cosine; pdf:
/// of the BSDF technique there.
struct ScatteredLight {
    Vec3<Packet> wo;
    Rgb<Packet> f;
    Packet pdf;
};
/// Of the lanes from i on.
ScatteredLight scatter_light(const auto& bsdf, const PointLanes& points, const LightColumns& light,
                             std::size_t i) {
    const Vec3<Packet> wo = direction_to_local(points, i, load(light.direction_world, i));
    const auto [f, pdf] = bsdf.eval_pdf(i, load(points.wi, i), wo);
    return {wo, f, pdf};
}

/// A light sample of each point, with its ScatteredLight and its weight.
struct LightCandidate {
    LightColumns light;
    ColumnVec3 wo, f;
    Column pdf, weight;
};

/// The choices of a batch.
struct LightCandidates {
    std::vector<LightCandidate> drawn;
    std::array<std::uint32_t, kMaxLanes> chosen;  ///< the candidate of each lane
    Column inverse_probability;
    Column u;  ///< by which they were made
};

/// Chooses for the points of `wanted`, where light samples have several candidates. u: four numbers
/// per lane, of the candidates.
void choose_candidates(const TraceInput& input, std::span<const BatchSample> samples,
                       const PointLanes& points, const PointBsdfs& bsdfs, const ActiveList& wanted,
                       std::uint32_t bounce, const std::array<Column, 4>& u, LightCandidates& out);

/// The chosen ones of the lanes from i on, their samples into `light`.
ScatteredLight take_chosen(const LightCandidates& candidates, std::size_t i, LightColumns& light);

}  // namespace burnish
