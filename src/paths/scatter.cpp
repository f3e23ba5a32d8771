#include "paths/scatter.h"

#include <algorithm>

namespace burnish {

namespace {

/// Parts of blends: their share is in f, and their probability in what multiplies the light, and
/// with it the value of a BSDF that has no other unknown. So no delta lobe asks for its direction
/// again.
void weigh_parts(const TraceInput& input, const PointLanes& points, SampleLanes& d) {
    for (std::size_t i = 0; points.has_shares && i < points.count; ++i) {
        Rgbf f = get(d.f, i), light{1, 1, 1};
        if (has_unknown_share_alone(input, points.bsdf[i])) std::swap(f, light);
        set(d.f, i, f * points.share[i]);
        set(d.part, i, light * (1 / points.chance[i]));
    }
}

/// Whether a ray for this lane can matter: its value is not zero, or its derivative may not be.
bool worth_tracing(const TraceInput& input, const PointLanes& points, const SampleLanes& d,
                   std::size_t i) {
    if (points.has_shares && is_black(get(d.part, i))) return false;
    if (!is_black(get(d.f, i))) return true;
    if (!input.keep_black || !points.has_unknowns[i]) return false;
    return d.wo.z[i] > 0 || transmits((*input.scene->scene)[points.bsdf[i]]);
}

/// The rays to the lights' points, from an origin that was moved off the surface.
void aim_at_lights(const PointLanes& points, const LightColumns& light, std::size_t i,
                   RayColumns& rays) {
    const Vec3<Packet> position = load(points.position, i),
                       direction = load(light.direction_world, i);
    const Packet distance = load(light.distance, i), one(1.0f);
    const Vec3<Packet> origin =
        leave_surface(position, load(points.geometric_normal, i), direction);
    const Vec3<Packet> to_light = position + direction * distance - origin;
    const Packet moved = length(to_light);
    const auto infinite = distance == Packet(kInfinity);
    store(rays.origin, i, origin);
    store(rays.direction, i, select(infinite, direction, to_light * (one / moved)));
    store(rays.max_distance, i, select(infinite, distance, moved * Packet(1 - kShadowShortening)));
}

/// MIS: the radiance over the sum of both techniques' densities. No other technique finds a point
/// light.
void weigh_lights(const LightColumns& light, std::size_t i, const Packet& pdf_bsdf,
                  ColumnVec3& radiance_over_pdf) {
    const Packet other = select(load(light.delta, i) > Packet(0.0f), 0.0f, pdf_bsdf);
    store(radiance_over_pdf, i,
          load(light.radiance, i) * inverse_density(load(light.pdf, i) + other));
}

/// The emission that BSDF samples head for, into `light`: shortens the rays that end on a shape,
/// and takes those that end on nothing that shines out of the list. Light from infinity is looked
/// up later, for those that reach it.
void find_emitting_shapes(const TracedScene& traced, const PointLanes& points, SampleLanes& d,
                          LightColumns& light) {
    ActiveList kept;
    const bool infinite = static_cast<bool>(traced.lights->infinite);
    for (std::size_t first = 0; first < d.arrived.count; first += kPacketRays) {
        const ColumnIndices lanes = indices(d.arrived, first);
        const HitPacket hits =
            traced.geometry->emitting.intersect(gather(d.rays, lanes), Coherence::kIncoherent);
        for (std::size_t k = 0; k < static_cast<std::size_t>(lanes.live); ++k) {
            const std::size_t i = lanes.at[k];
            if (hits.shape[k] < 0) {
                if (infinite) kept.add(i);
                continue;
            }
            const Hit hit = hit_of(hits, k);
            const EmissionSample e = emission_at_hit(*traced.lights, hit, get(points.position, i),
                                                     get(d.rays.direction, i));
            if (is_black(e.radiance)) continue;
            set(light.radiance, i, e.radiance);
            light.pdf[i] = e.pdf;
            d.rays.max_distance[i] = hit.distance * (1 - kShadowShortening);
            kept.add(i);
        }
    }
    d.arrived = kept;
}

/// Value and density of a sample; of a delta lobe its share and its probability, and the lane says
/// so.
BsdfValue<Packet> value_of_sample(const auto& bsdf, std::size_t i, const Vec3<Packet>& wi,
                                  const SampledDirection<Packet>& sampled, SampleLanes& d) {
    auto value = bsdf.eval_pdf(i, wi, sampled.wo_local);
    if constexpr (std::remove_cvref_t<decltype(bsdf)>::kHasDelta) {
        for (std::size_t k = 0; k < kLanes; ++k)
            d.delta[i + k] = get(sampled.delta, static_cast<int>(k));
        value.f = select(sampled.delta, sampled.lobe.f, value.f);
        value.pdf = select(sampled.delta, sampled.lobe.pdf, value.pdf);
    }
    return value;
}

/// Light samples never find the directions of delta lobes: their density is left out there.
void leave_out_lights(const SampleLanes& d, Column& pdf) {
    for (std::size_t k = 0; k < d.arrived.count; ++k)
        if (d.delta[d.arrived.lane[k]]) pdf[d.arrived.lane[k]] = 0;
}

/// What normal maps leave of the light of each sample that arrives.
void find_shares(const TraceInput& input, const PointLanes& points, const ColumnVec3& direction,
                 SampleLanes& d) {
    for (std::size_t k = 0; k < d.arrived.count; ++k) {
        const std::size_t i = d.arrived.lane[k];
        d.share[i] = share_of_light(*input.scene->scene, points, i, get(direction, i));
    }
}

/// The live points whose sample wants a light sample, and whose BSDF can scatter it.
ActiveList want_light(std::span<const BatchSample> samples, const PointLanes& points,
                      const PointBsdfs& bsdfs) {
    ActiveList wanted;
    std::size_t k = 0;
    bsdfs.for_each_kind([&]<class Kind>(const Kind&, const IndexRange& range) {
        for (; k < points.live.count && points.live.lane[k] < range.end; ++k)
            if (!Kind::kHasOnlyDelta && samples[points.sample[points.live.lane[k]]].emitter)
                wanted.add(points.live.lane[k]);
    });
    return wanted;
}

}  // namespace

PointBsdfs bsdfs_of(const TraceInput& input, const PointLanes& points, ScatterWorkspace& w) {
    const BsdfPoints at{input.scene->scene, input.textures, points.bsdf, &points.u, &points.v, {}};
    return {make_mixture_packets(at, points.kinds, input.mixture, w.parameters), points.kinds};
}

void sample_emitters(const TraceInput& input, std::span<const BatchSample> samples,
                     const PointLanes& points, const PointBsdfs& bsdfs, std::uint32_t bounce,
                     ScatterWorkspace& w) {
    SampleLanes& d = w.samples;
    draw_uniforms(input, samples, points, Technique::kEmitter, bounce, d.uniform);
    const ActiveList wanted = want_light(samples, points, bsdfs);
    const bool chooses = candidates_of(input.scene->lights->selector) > 1;
    if (chooses)
        choose_candidates(input, samples, points, bsdfs, wanted, bounce, d.uniform, w.candidates);
    else
        sample_lights(*input.scene->lights, d.uniform, points.position, wanted, points.count, 0,
                      w.light);
    bsdfs.for_each_kind([&]<class Kind>(const Kind& bsdf, const IndexRange& range) {
        if (Kind::kHasOnlyDelta) return;
        for (std::size_t i = range.begin; i < range.end; i += kLanes) {
            const auto [wo, f, pdf] = chooses ? take_chosen(w.candidates, i, w.light)
                                              : scatter_light(bsdf, points, w.light, i);
            store(d.wo, i, wo);
            store(d.f, i, f);
            weigh_lights(w.light, i, pdf, d.radiance_over_pdf);
            aim_at_lights(points, w.light, i, d.rays);
        }
    });
    weigh_parts(input, points, d);
    d.arrived.count = 0;
    for (std::size_t k = 0; k < wanted.count; ++k) {
        const std::size_t i = wanted.lane[k];
        if (chooses)
            set(d.radiance_over_pdf, i,
                get(d.radiance_over_pdf, i) * w.candidates.inverse_probability[i]);
        if (!(w.light.pdf[i] <= 0) && !is_black(get(w.light.radiance, i)) &&
            worth_tracing(input, points, d, i))
            d.arrived.add(i);
    }
    if (points.has_turned) find_shares(input, points, w.light.direction_world, d);
    dim(points, d);
}

void trace_shadow_rays(const TraceInput& input, SampleLanes& d) {
    sort_by_direction(d.rays.direction, d.arrived);
    keep_unoccluded(input.scene->geometry->accel, d.rays, d.arrived);
}

void sample_bsdfs(const TraceInput& input, std::span<const BatchSample> samples,
                  const PointLanes& points, const PointBsdfs& bsdfs, std::uint32_t bounce,
                  ScatterWorkspace& w) {
    SampleLanes& d = w.samples;
    draw_uniforms(input, samples, points, Technique::kBsdf, bounce, d.uniform);
    const auto& u = d.uniform;
    std::fill_n(d.delta.begin(), points.count, 0);
    bsdfs.for_each_kind([&](const auto& bsdf, const IndexRange& range) {
        for (std::size_t i = range.begin; i < range.end; i += kLanes) {
            const Vec3<Packet> wi = load(points.wi, i);
            const auto sampled =
                bsdf.sample(i, wi, {load(u[0], i), load(u[1], i)}, load(u[2], i), load(u[3], i));
            const Vec3<Packet>& wo = sampled.wo_local;
            const auto [f, pdf] = value_of_sample(bsdf, i, wi, sampled, d);
            store(d.wo, i, wo);
            store(d.f, i, f);
            store(d.pdf, i, select(sampled.proper, pdf, Packet(0.0f)));
            store(d.eta, i, sampled.eta);
            const Vec3<Packet> direction = direction_to_world(points, i, wo);
            store(d.rays.origin, i,
                  leave_surface(load(points.position, i), load(points.geometric_normal, i),
                                direction));
            store(d.rays.direction, i, direction);
            store(d.rays.max_distance, i, Packet(kInfinity));
        }
    });
    weigh_parts(input, points, d);
    d.arrived.count = 0;
    for (std::size_t k = 0; k < points.live.count; ++k) {
        const std::size_t i = points.live.lane[k];
        if (samples[points.sample[i]].bsdf && d.pdf[i] > 0 && worth_tracing(input, points, d, i))
            d.arrived.add(i);
    }
    if (points.has_turned) find_shares(input, points, d.rays.direction, d);
}

void dim(const PointLanes& points, SampleLanes& d) {
    for (std::size_t k = 0; points.has_turned && k < d.arrived.count; ++k) {
        const std::size_t i = d.arrived.lane[k];
        set(d.radiance_over_pdf, i, get(d.radiance_over_pdf, i) * d.share[i]);
    }
    for (std::size_t k = 0; points.has_shares && k < d.arrived.count; ++k) {
        const std::size_t i = d.arrived.lane[k];
        set(d.radiance_over_pdf, i, get(d.radiance_over_pdf, i) * get(d.part, i));
    }
}

void find_emission(const TraceInput& input, const PointLanes& points, ScatterWorkspace& w) {
    const TracedScene& traced = *input.scene;
    SampleLanes& d = w.samples;
    sort_by_direction(d.rays.direction, d.arrived);
    if (traced.geometry->has_emitting)
        find_emitting_shapes(traced, points, d, w.light);
    else if (!traced.lights->infinite)
        d.arrived.count = 0;
    keep_unoccluded(traced.geometry->accel, d.rays, d.arrived);
    ActiveList escaped;
    for (std::size_t k = 0; k < d.arrived.count; ++k)
        if (d.rays.max_distance[d.arrived.lane[k]] == kInfinity) escaped.add(d.arrived.lane[k]);
    emission_at_infinity(*traced.lights, points.position, d.rays.direction, escaped,
                         w.light.radiance, w.light.pdf);
    leave_out_lights(d, w.light.pdf);
    for (std::size_t k = 0; k < d.arrived.count; ++k) {
        const std::size_t i = d.arrived.lane[k];
        set(d.radiance_over_pdf, i,
            get(w.light.radiance, i) * inverse_density(w.light.pdf[i] + d.pdf[i]));
    }
}

}  // namespace burnish
