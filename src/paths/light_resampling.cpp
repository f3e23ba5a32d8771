#include "paths/light_resampling.h"

namespace burnish {

namespace {

/// e: of all choices.
constexpr float kEvenShare = 0.1f;

/// From the light of a candidate the rest of it. Under a mixture the density stands for the BSDF's
/// value, which is that of one component.
void weigh_candidate(const TraceInput& input, const PointLanes& points, const PointBsdfs& bsdfs,
                     LightCandidate& candidate) {
    const LightColumns& light = candidate.light;
    bsdfs.for_each_kind([&]<class Kind>(const Kind& bsdf, const IndexRange& range) {
        if (Kind::kHasOnlyDelta) return;
        for (std::size_t i = range.begin; i < range.end; i += kLanes) {
            const auto [wo, f, pdf] = scatter_light(bsdf, points, light, i);
            store(candidate.wo, i, wo);
            store(candidate.f, i, f);
            store(candidate.pdf, i, pdf);
            const Packet zero(0.0f), p_e = load(light.pdf, i);
            const Packet p_b = select(load(light.delta, i) > zero, zero, pdf);
            const Rgb<Packet> value = input.mixture.empty() ? f : Rgb<Packet>{pdf, pdf, pdf};
            const Packet weight =
                candidate_weight(value, load(light.radiance, i), Packet(p_e + p_b));
            store(candidate.weight, i, select(p_e > zero, weight, zero));
        }
    });
}

}  // namespace

CandidateChoice choose_candidate(std::span<const float> weights, float u) {
    float total = 0;
    for (const float w : weights) total += w;
    const bool any = total > 0 && total <= std::numeric_limits<float>::max();
    const float min = (any ? kEvenShare : 1) / static_cast<float>(weights.size());
    const float scale = any ? (1 - kEvenShare) / total : 0;
    std::uint32_t c = 0;
    float probability = min + scale * weights[0];
    while (u >= probability && c + 1 < weights.size()) {
        u -= probability;
        probability = min + scale * weights[++c];
    }
    return {c, 1 / probability};
}

void choose_candidates(const TraceInput& input, std::span<const BatchSample> samples,
                       const PointLanes& points, const PointBsdfs& bsdfs, const ActiveList& wanted,
                       std::uint32_t bounce, const std::array<Column, 4>& u, LightCandidates& out) {
    const Lights& lights = *input.scene->lights;
    const std::uint32_t count = candidates_of(lights.selector);
    out.drawn.resize(count);
    for (std::uint32_t c = 0; c < count; ++c) {
        sample_lights(lights, u, points.position, wanted, points.count, c, out.drawn[c].light);
        weigh_candidate(input, points, bsdfs, out.drawn[c]);
    }
    draw_choice(input, samples, points, bounce, out.u);
    for (std::size_t k = 0; k < wanted.count; ++k) {
        const std::size_t i = wanted.lane[k];
        std::array<float, kMaxCandidates> weights;
        for (std::uint32_t c = 0; c < count; ++c) weights[c] = out.drawn[c].weight[i];
        const CandidateChoice choice = choose_candidate(std::span(weights).first(count), out.u[i]);
        out.chosen[i] = choice.candidate;
        out.inverse_probability[i] = choice.inverse_probability;
    }
}

ScatteredLight take_chosen(const LightCandidates& candidates, std::size_t i, LightColumns& light) {
    std::array<float, kLanes> chosen;
    for (std::size_t k = 0; k < kLanes; ++k)
        chosen[k] = static_cast<float>(candidates.chosen[i + k]);
    const Packet which = load(chosen.data());
    const auto take = [&](const auto& column_of) {
        auto value = load(column_of(candidates.drawn[0]), i);
        for (std::size_t c = 1; c < candidates.drawn.size(); ++c)
            value = select(which == Packet(static_cast<float>(c)),
                           load(column_of(candidates.drawn[c]), i), value);
        return value;
    };
    const auto sample = [&](auto column) {
        store(light.*column, i,
              take([=](const LightCandidate& c) -> const auto& { return c.light.*column; }));
    };
    sample(&LightColumns::direction_world), sample(&LightColumns::distance);
    sample(&LightColumns::radiance), sample(&LightColumns::pdf), sample(&LightColumns::delta);
    const auto scattered = [&](auto column) {
        return take([=](const LightCandidate& c) -> const auto& { return c.*column; });
    };
    return {scattered(&LightCandidate::wo), scattered(&LightCandidate::f),
            scattered(&LightCandidate::pdf)};
}

}  // namespace burnish
