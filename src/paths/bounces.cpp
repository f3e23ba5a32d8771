#include "paths/bounces.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/finite_lanes.h"
#include "core/random_packet.h"
#include "paths/primary_rays.h"
#include "paths/scatter.h"

namespace burnish {

namespace {

/// Russian roulette: a path goes on with at most and, where derivatives by black textures are asked
/// for, at least this probability.
constexpr float kMaxSurvival = 0.95f, kMinSurvival = 0.05f;
/// A path of any rr_depth may end from here on: without, one in a closed scene would not.
constexpr std::uint32_t kLatestRoulette = 256;

/// The state of each path of a batch.
struct PathLanes {
    ColumnVec3 throughput;                  ///< from the camera on
    ColumnVec3 onward;                      ///< from the last recorded vertex on, its BSDF left out
    ColumnVec3 position;                    ///< of the last point
    Column pdf;                             ///< with which the ray was sampled
    Column eta;                             ///< product of all so far
    std::array<char, kBatchSamples> delta;  ///< the ray is that of a delta lobe
    std::array<char, kBatchSamples> counts;          ///< what the path gathers is wanted
    std::array<std::int32_t, kBatchSamples> vertex;  ///< the last recorded one; -1: none
};

/// Memory of the stages, reused from batch to batch.
struct BounceWorkspace {
    FilmLanes film;
    RayLanes rays;
    PointLanes points;
    ScatterWorkspace scatter;
    PathLanes paths;
    std::array<BatchSample, kBatchSamples> samples;  ///< with the techniques that are wanted
};

/// The paths of a batch while they are traced.
struct Tracer {
    TraceInput input;  ///< on all surfaces
    SurfaceChoice choice;
    std::span<const BatchSample> samples;
    std::span<Rgbf> radiance;            ///< of each sample: what no recorded vertex scatters
    std::vector<ChainVertex>* vertices;  ///< those with unknowns so far; null: they are not kept
    BounceWorkspace& w;
};

/// The vertex that lane i of the points is; null where it is not recorded.
ChainVertex* vertex_at(Tracer& t, std::size_t i) {
    if (!t.vertices || !t.w.points.has_unknowns[i]) return nullptr;
    return &(*t.vertices)[static_cast<std::size_t>(t.w.paths.vertex[t.w.points.sample[i]])];
}

/// Adds light that path s has gathered since its last recorded vertex.
void gather_light(Tracer& t, std::size_t s, const Rgbf& light) {
    if (t.w.paths.vertex[s] >= 0)
        (*t.vertices)[static_cast<std::size_t>(t.w.paths.vertex[s])].gathered += light;
    else if (t.w.paths.counts[s])
        t.radiance[s] += light;
}

void begin_paths(Tracer& t) {
    PathLanes& p = t.w.paths;
    for (std::size_t s = 0; s < t.samples.size(); ++s) {
        set(p.throughput, s, {1, 1, 1}), set(p.onward, s, {1, 1, 1});
        p.eta[s] = 1;
        p.counts[s] = t.choice != SurfaceChoice::kUnknown;
        p.vertex[s] = -1;
        t.w.samples[s] = {t.samples[s].camera, p.counts[s] != 0, true};
    }
}

/// What the paths do at surfaces with unknowns: a constant part ends there, others count from there
/// on, and the point becomes a vertex.
void visit_unknowns(Tracer& t) {
    PointLanes& points = t.w.points;
    PathLanes& p = t.w.paths;
    ActiveList kept;
    for (std::size_t k = 0; k < points.live.count; ++k) {
        const std::size_t i = points.live.lane[k], s = points.sample[i];
        if (points.has_unknowns[i]) {
            if (t.choice == SurfaceChoice::kConstant) continue;
            p.counts[s] = 1;
            t.w.samples[s].emitter = true;
            if (t.vertices) {
                if (p.vertex[s] >= 0) {
                    (*t.vertices)[static_cast<std::size_t>(p.vertex[s])].onward = get(p.onward, s);
                    set(p.onward, s, {1, 1, 1});
                }
                p.vertex[s] = static_cast<std::int32_t>(t.vertices->size());
                ChainVertex& vertex = t.vertices->emplace_back();
                vertex.sample = static_cast<int>(s);
                vertex.bsdf = points.bsdf[i];
                vertex.uv = {points.u[i], points.v[i]};
                vertex.wi = get(points.wi, i);
            }
        }
        kept.add(i);
    }
    points.live = kept;
}

/// The light samples at the points.
void gather_emitters(Tracer& t, const PointBsdfs& bsdfs, std::uint32_t bounce) {
    sample_emitters(t.input, t.w.samples, t.w.points, bsdfs, bounce, t.w.scatter);
    trace_shadow_rays(t.input, t.w.scatter.samples);
    const SampleLanes& d = t.w.scatter.samples;
    for_arrived(d, t.w.points.count, [&](std::size_t i) {
        const std::size_t s = t.w.points.sample[i];
        const Rgbf light = get(t.w.paths.onward, s) * get(d.radiance_over_pdf, i);
        if (ChainVertex* vertex = vertex_at(t, i)) {
            vertex->emitted = light;
            vertex->f_light = get(d.f, i), vertex->wo_light = get(d.wo, i);
        } else {
            gather_light(t, s, light * get(d.f, i));
        }
    });
}

/// With which probability paths of these throughputs go on.
Packet survival(const Tracer& t, const Rgb<Packet>& throughput, const Packet& eta) {
    const Packet largest =
        max(abs(throughput.x), max(abs(throughput.y), abs(throughput.z))) * eta * eta;
    return min(Packet(kMaxSurvival),
               max(Packet(t.input.keep_black ? kMinSurvival : 0.0f), largest));
}

/// Of the samples of sixteen lanes.
Packet roulette_numbers(const Tracer& t, const ColumnIndices& samples, std::uint32_t bounce) {
    LaneIntegers pixel, iteration, pass;
    for (int k = 0; k < kLanes; ++k) {
        const CameraSample& c = t.samples[samples.at[static_cast<std::size_t>(k)]].camera;
        set(pixel, k, c.pixel), set(iteration, k, c.iteration), set(pass, k, c.pass);
    }
    return uniforms(t.input.key, pixel, iteration, pass, kRouletteNumbers | bounce)[0];
}

/// What the paths of sixteen lanes carry on. Returns which of them go on.
Mask carry_on(Tracer& t, const ColumnIndices& lanes, const ColumnIndices& samples,
              std::uint32_t bounce) {
    SampleLanes& d = t.w.scatter.samples;
    PathLanes& p = t.w.paths;
    const Packet one(1.0f);
    const Rgb<Packet> f = gather(d.f, lanes);
    const Packet pdf = gather(d.pdf, lanes), eta = gather(p.eta, samples) * gather(d.eta, lanes);
    Packet weight = inverse_density(pdf);
    Rgb<Packet> throughput = gather(p.throughput, samples) * f * weight;
    if (t.w.points.has_turned) {
        const Packet share = gather(d.share, lanes);
        throughput = throughput * share;
        weight = weight * share;
    }
    Rgb<Packet> onward = gather(p.onward, samples);
    if (t.w.points.has_shares) {
        const Rgb<Packet> part = gather(d.part, lanes);
        throughput = throughput * part;
        onward = onward * part;
    }
    Mask goes_on(true);
    const auto rr_depth = static_cast<std::uint32_t>(t.input.scene->scene->rr_depth);
    if (bounce + 1 >= std::min(rr_depth, kLatestRoulette)) {
        const Packet chance = survival(t, throughput, eta);
        // What is not finite goes on: ends_here counts it.
        goes_on = !(roulette_numbers(t, samples, bounce) >= chance && finite_lanes(throughput));
        weight = weight / chance;
        throughput = throughput * (one / chance);
    }
    Mask is_vertex(false);
    for (int k = 0; t.vertices && k < kLanes; ++k)
        set(is_vertex, k, t.w.points.has_unknowns[lanes.at[static_cast<std::size_t>(k)]] != 0);
    onward = onward * weight;
    scatter(p.throughput, samples, throughput);
    scatter(p.onward, samples, select(is_vertex, onward, onward * f));
    scatter(p.eta, samples, eta);
    scatter(p.position, samples, gather(t.w.points.position, lanes));
    scatter(p.pdf, samples, pdf);
    return goes_on;
}

/// Whether a path brings nothing more: it is black, or not finite, which its light then tells.
bool ends_here(Tracer& t, std::size_t s) {
    const PathLanes& p = t.w.paths;
    const Rgbf throughput = get(p.throughput, s);
    if (!is_finite(throughput)) {
        gather_light(t, s, throughput);
        return true;
    }
    return is_black(throughput) && (!t.input.keep_black || is_black(get(p.onward, s)));
}

/// Moves the paths whose BSDF sample can matter on along it; Russian roulette ends some of them.
void leave_points(Tracer& t, std::uint32_t bounce) {
    SampleLanes& d = t.w.scatter.samples;
    ActiveList kept;
    for (std::size_t first = 0; first < d.arrived.count; first += kLanes) {
        const ColumnIndices lanes = indices(d.arrived, first);
        ColumnIndices samples{{}, lanes.live};
        for (std::size_t k = 0; k < kLanes; ++k) samples.at[k] = t.w.points.sample[lanes.at[k]];
        const Mask goes_on = carry_on(t, lanes, samples, bounce);
        for (int k = 0; k < lanes.live; ++k) {
            if (!get(goes_on, k) || ends_here(t, samples.at[static_cast<std::size_t>(k)])) continue;
            const std::size_t i = lanes.at[static_cast<std::size_t>(k)];
            if (ChainVertex* vertex = vertex_at(t, i))
                vertex->f_next = get(d.f, i), vertex->wo_next = get(d.wo, i);
            t.w.paths.delta[t.w.points.sample[i]] = d.delta[i];
            kept.add(i);
        }
    }
    d.arrived = kept;
}

/// The light that the rays of paths without a further point reach.
void gather_last_emission(Tracer& t) {
    find_emission(t.input, t.w.points, t.w.scatter);
    const SampleLanes& d = t.w.scatter.samples;
    for_arrived(d, t.w.points.count, [&](std::size_t i) {
        const std::size_t s = t.w.points.sample[i];
        gather_light(t, s,
                     get(t.w.paths.onward, s) * get(d.radiance_over_pdf, i) * t.w.paths.pdf[s]);
    });
}

/// Traces the rays of the paths that go on: their surfaces.
void trace_onward(Tracer& t) {
    const TracedScene& traced = *t.input.scene;
    SampleLanes& d = t.w.scatter.samples;
    RayLanes& rays = t.w.rays;
    std::fill_n(rays.shape.begin(), t.samples.size(), -1);
    sort_by_direction(d.rays.direction, d.arrived);
    for (std::size_t first = 0; first < d.arrived.count; first += kPacketRays) {
        const ColumnIndices lanes = indices(d.arrived, first);
        const HitPacket hits =
            traced.geometry->accel.intersect(gather(d.rays, lanes), Coherence::kIncoherent);
        for (std::size_t k = 0; k < static_cast<std::size_t>(lanes.live); ++k) {
            const std::size_t i = lanes.at[k], s = t.w.points.sample[i];
            set(rays.rays.origin, s, get(d.rays.origin, i));
            set(rays.rays.direction, s, get(d.rays.direction, i));
            set_hit(rays, s, hit_of(hits, k));
            prefetch(traced.geometry->triangles, hits.shape[k], hits.primitive[k]);
        }
    }
}

/// Light of an emitter that a BSDF sample met, weighed against light samples (balance heuristic).
Rgbf weighed(const PathLanes& p, std::size_t s, const Rgbf& radiance, float pdf_emitter) {
    const float other = p.delta[s] ? 0.0f : pdf_emitter;
    const float sum = p.pdf[s] + other;
    return get(p.onward, s) * radiance * (std::isfinite(sum) ? p.pdf[s] / sum : NAN);
}

/// The emission that the rays of the paths that go on met.
void gather_emission(Tracer& t) {
    const Lights& lights = *t.input.scene->lights;
    const ActiveList& list = t.w.scatter.samples.arrived;
    const RayLanes& rays = t.w.rays;
    ActiveList escaped;
    for (std::size_t k = 0; k < list.count; ++k) {
        const std::size_t s = t.w.points.sample[list.lane[k]];
        if (rays.shape[s] < 0) {
            escaped.add(s);
        } else if (lights.of_shape[static_cast<std::size_t>(rays.shape[s])]) {
            const EmissionSample e = emission_at_hit(
                lights, hit_of(rays, s), get(t.w.paths.position, s), get(rays.rays.direction, s));
            if (!is_black(e.radiance)) gather_light(t, s, weighed(t.w.paths, s, e.radiance, e.pdf));
        }
    }
    if (!lights.infinite) return;
    ColumnVec3& radiance = t.w.scatter.light.radiance;
    Column& pdf = t.w.scatter.light.pdf;
    emission_at_infinity(lights, t.w.paths.position, rays.rays.direction, escaped, radiance, pdf);
    for (std::size_t k = 0; k < escaped.count; ++k) {
        const std::size_t s = escaped.lane[k];
        gather_light(t, s, weighed(t.w.paths, s, get(radiance, s), pdf[s]));
    }
}

/// Traces paths until none goes on.
void trace_paths(Tracer& t) {
    const auto max_depth = static_cast<std::uint32_t>(t.input.scene->scene->max_depth);
    TraceInput primary = t.input;
    primary.choice = t.choice;
    trace_primary_rays(primary, t.samples, t.w.film, t.w.rays, t.radiance);
    if (max_depth == 0) std::fill(t.radiance.begin(), t.radiance.end(), Rgbf{});
    begin_paths(t);
    if (t.input.scene->lights->lights.empty()) return;
    for (std::uint32_t bounce = 0; bounce + 1 < max_depth; ++bounce) {
        find_points(t.input, t.samples.size(), t.w.rays, t.w.points);
        visit_unknowns(t);
        if (t.w.points.live.count == 0) return;
        const PointBsdfs bsdfs = bsdfs_of(t.input, t.w.points, t.w.scatter);
        gather_emitters(t, bsdfs, bounce);
        sample_bsdfs(t.input, t.w.samples, t.w.points, bsdfs, bounce, t.w.scatter);
        leave_points(t, bounce);
        if (bounce + 2 == max_depth) return gather_last_emission(t);
        trace_onward(t);
        gather_emission(t);
    }
}

BounceWorkspace& workspace() {
    thread_local const auto w = std::make_unique<BounceWorkspace>();  // scratch memory only
    return *w;
}

void trace(const TraceInput& input, std::span<const BatchSample> samples, std::span<Rgbf> radiance,
           std::vector<ChainVertex>* vertices) {
    Tracer t{input, input.choice, samples, radiance, vertices, workspace()};
    t.input.choice = SurfaceChoice::kAll;
    trace_paths(t);
}

}  // namespace

void trace_vertices(const TraceInput& input, std::span<const BatchSample> samples,
                    std::span<Rgbf> emitted, std::vector<ChainVertex>& vertices) {
    trace(input, samples, emitted, &vertices);
}

void trace_bounces(const TraceInput& input, std::span<const BatchSample> samples,
                   std::span<Rgbf> radiance) {
    trace(input, samples, radiance, nullptr);
}

}  // namespace burnish
