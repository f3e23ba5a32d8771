#include "paths/light_resampling.h"

namespace burnish {

namespace {

/// e: of all choices.
constexpr float kEvenShare = 0.1f;

/// The weights of what `light` holds. Under a mixture the density stands for the BSDF's value,
/// which is that of one component.
void weigh_candidates(const TraceInput& input, const PointLanes& points, const PointBsdfs& bsdfs,
                      const LightColumns& light, Column& weights) {
    bsdfs.for_each_kind([&]<class Kind>(const Kind& bsdf, const LaneRange& range) {
        if (Kind::kHasOnlyDelta) return;
        for (std::size_t i = range.begin; i < range.end; i += kLanes) {
            const Vec3<Packet> wo = direction_to_local(points, i, load(light.direction_world, i));
            const auto [f, pdf] = bsdf.eval_pdf(i, load(points.wi, i), wo);
            const Packet zero(0.0f), p_e = load(light.pdf, i);
            const Packet p_b = select(load(light.delta, i) > zero, zero, pdf);
            const Rgb<Packet> value = input.mixture.empty() ? f : Rgb<Packet>{pdf, pdf, pdf};
            const Packet weight =
                candidate_weight(value, load(light.radiance, i), Packet(p_e + p_b));
            store(weights, i, select(p_e > zero, weight, zero));
        }
    });
}

}  // namespace

CandidateChoice choose_candidate(std::span<const float> weights, float u) {
    float total = 0;
    for (const float w : weights) total += w;
    const bool any = total > 0 && total <= std::numeric_limits<float>::max();
    const float least = (any ? kEvenShare : 1) / static_cast<float>(weights.size());
    const float scale = any ? (1 - kEvenShare) / total : 0;
    std::uint32_t c = 0;
    float probability = least + scale * weights[0];
    while (u >= probability && c + 1 < weights.size()) {
        u -= probability;
        probability = least + scale * weights[++c];
    }
    return {c, 1 / probability};
}

void choose_candidates(const TraceInput& input, std::span<const BatchSample> samples,
                       const PointLanes& points, const PointBsdfs& bsdfs, const ActiveList& wanted,
                       std::uint32_t bounce, const std::array<Column, 4>& u, LightColumns& light,
                       LightCandidates& out) {
    const Lights& lights = *input.scene->lights;
    const std::uint32_t count = candidates_of(lights.selector);
    for (std::uint32_t c = 0; c < count; ++c) {
        out.chosen.fill(c);
        sample_lights(lights, u, points.position, wanted, points.count, &out.chosen, light);
        weigh_candidates(input, points, bsdfs, light, out.weights[c]);
    }
    draw_choice(input, samples, points, bounce, out.u);
    for (std::size_t k = 0; k < wanted.count; ++k) {
        const std::size_t i = wanted.lane[k];
        std::array<float, kMaxCandidates> weights;
        for (std::uint32_t c = 0; c < count; ++c) weights[c] = out.weights[c][i];
        const CandidateChoice choice = choose_candidate(std::span(weights).first(count), out.u[i]);
        out.chosen[i] = choice.candidate;
        out.inverse_probability[i] = choice.inverse_probability;
    }
}

}  // namespace burnish
