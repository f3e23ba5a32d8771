#include "paths/trace.h"

#include <algorithm>
#include <initializer_list>
#include <memory>
#include <vector>

#include "core/contract.h"
#include "paths/chains.h"
#include "paths/primary_rays.h"
#include "paths/scatter.h"

namespace burnish {

namespace {

/// The stages' shared memory, reused from batch to batch.
struct TraceWorkspace {
    FilmLanes film;
    RayLanes primary;
    PointLanes points;
    ScatterWorkspace scatter;
};

/// One of each thread that traces direct light: nothing in it outlives a call.
TraceWorkspace& trace_workspace() {
    thread_local const auto w = std::make_unique<TraceWorkspace>();
    return *w;
}

/// Calls keep(lane, value) for each sample that arrived, in order of lanes. Returns the number
/// of samples whose value was not finite.
std::size_t keep_samples(const TraceInput& input, const TraceWorkspace& w, const auto& keep) {
    const SampleLanes& d = w.scatter.samples;
    std::size_t rejected = 0;
    for_arrived(d, w.points.count, [&](std::size_t i) {
        if (is_black(get(d.radiance_over_pdf, i))) return;
        const Rgbf value = get(d.f, i) * get(d.radiance_over_pdf, i);
        if (is_black(value) && !(input.keep_black && w.points.has_unknowns[i])) return;
        if (is_finite(value))
            keep(i, value);
        else
            ++rejected;
    });
    return rejected;
}

PathRecord record_of(std::span<const BatchSample> samples, const TraceWorkspace& w,
                     Technique technique, std::size_t i) {
    const PointLanes& p = w.points;
    const SampleLanes& d = w.scatter.samples;
    const std::size_t s = p.sample[i];
    return {samples[s].camera.pixel, technique,    p.bsdf[i],    w.film.film_pass[s],
            {p.u[i], p.v[i]},        get(p.wi, i), get(d.wo, i), get(d.radiance_over_pdf, i)};
}

void check(const TraceInput& input, std::span<const BatchSample> samples) {
    BURNISH_REQUIRE(samples.size(), <=, std::size_t{kBatchSamples});
    BURNISH_REQUIRE(input.passes_per_iteration, >=, 1u);
    BURNISH_REQUIRE(input.textures->textures.size(), ==, input.scene->scene->textures.size());
    BURNISH_REQUIRE(input.mixture.size(), <=, kMaxComponents);
    for (const ConstantTextures& component : input.mixture)
        BURNISH_REQUIRE(component.size(), ==, input.scene->scene->textures.size());
    if (!input.unknown_bsdfs.empty())
        BURNISH_REQUIRE(input.unknown_bsdfs.size(), ==, input.scene->scene->bsdfs.size());
}

/// From the hits of primary rays: calls keep(technique, lane, value) for each sample of
/// `techniques`. find_lit() leaves those of the light samples that arrive. Returns the number of
/// rejected ones.
std::size_t scatter_at_hits(const TraceInput& input, std::span<const BatchSample> samples,
                            std::initializer_list<Technique> techniques, TraceWorkspace& w,
                            const auto& find_lit, const auto& keep) {
    find_points(input, samples.size(), w.primary, w.points);
    if (w.points.live.count == 0 || input.scene->lights->lights.empty()) return 0;
    const PointBsdfs bsdfs = bsdfs_of(input, w.points, w.scatter);
    std::size_t rejected = 0;
    for (const Technique technique : techniques) {
        if (technique == Technique::kEmitter) {
            sample_emitters(input, samples, w.points, bsdfs, 0, w.scatter);
            find_lit();
        } else {
            sample_bsdfs(input, samples, w.points, bsdfs, 0, w.scatter);
            find_emission(input, w.points, w.scatter);
            dim(w.points, w.scatter.samples);
        }
        rejected += keep_samples(
            input, w, [&](std::size_t i, const Rgbf& value) { keep(technique, i, value); });
    }
    return rejected;
}

/// Runs all stages for direct light: emitted[i] is set to the light that sample i sees directly,
/// and keep(workspace, technique, lane, value) is called for each direct sample. Returns the number
/// of rejected ones.
std::size_t trace_direct(const TraceInput& input, std::span<const BatchSample> samples,
                         std::span<Rgbf> emitted, const auto& keep) {
    TraceWorkspace& w = trace_workspace();
    trace_primary_rays(input, samples, w.film, w.primary, emitted);
    return leave_out_non_finite(emitted) +
           scatter_at_hits(
               input, samples, {Technique::kEmitter, Technique::kBsdf}, w,
               [&] { trace_shadow_rays(input, w.scatter.samples); },
               [&](Technique technique, std::size_t i, const Rgbf& value) {
                   keep(w, technique, i, value);
               });
}

/// Of light samples that arrived under other textures, with these records: all where textures do
/// not choose the light; otherwise a new direction needs its shadow ray.
void find_lit_again(const TraceInput& input, std::span<const PathRecord> records,
                    TraceWorkspace& w) {
    if (candidates_of(input.scene->lights->selector) == 1) return;
    SampleLanes& d = w.scatter.samples;
    ActiveList lit, moved;
    for (std::size_t k = 0; k < d.arrived.count; ++k) {
        const std::size_t i = d.arrived.lane[k];
        const bool stayed = records[w.points.sample[i]].wo_local == get(d.wo, i);
        (stayed ? lit : moved).add(i);
    }
    d.arrived = moved;
    trace_shadow_rays(input, d);
    for (std::size_t k = 0; k < lit.count; ++k) d.arrived.add(lit.lane[k]);
}

}  // namespace

void trace_batch(const TraceInput& input, std::span<const BatchSample> samples, BatchOutput& out) {
    check(input, samples);
    out.emitted.resize(samples.size());
    out.direct_samples.clear();
    if (has_bounces(*input.scene->scene)) {
        thread_local ChainOutput chains;  // scratch memory only
        trace_chains(input, samples, chains);
        out.emitted = chains.emitted;
        out.rejected = chains.rejected + append_samples(input, samples, chains, out.direct_samples);
        return;
    }
    out.rejected = trace_direct(
        input, samples, out.emitted,
        [&](const TraceWorkspace& w, Technique technique, std::size_t i, const Rgbf& value) {
            const std::size_t s = w.points.sample[i];
            out.direct_samples.push_back({static_cast<int>(s), 0,
                                          record_of(samples, w, technique, i), value,
                                          w.points.has_unknowns[i] != 0, hit_of(w.primary, s)});
        });
}

std::size_t replay_batch(const TraceInput& input, Technique technique,
                         std::span<const CameraSample> camera_samples, std::span<const Hit> hits,
                         std::span<PathRecord> records) {
    BURNISH_REQUIRE(has_bounces(*input.scene->scene), ==, false);
    BURNISH_REQUIRE(hits.size(), ==, camera_samples.size());
    const bool emitter = technique == Technique::kEmitter;
    std::vector<BatchSample> samples;
    for (const CameraSample& s : camera_samples) samples.push_back({s, emitter, !emitter});
    check(input, samples);
    TraceWorkspace& w = trace_workspace();
    repeat_primary_rays(input, samples, hits, w.film, w.primary);
    std::array<PathRecord, kBatchSamples> replayed{};
    const std::size_t rejected = scatter_at_hits(
        input, samples, {technique}, w, [&] { find_lit_again(input, records, w); },
        [&](Technique, std::size_t i, const Rgbf&) {
            replayed[w.points.sample[i]] = record_of(samples, w, technique, i);
        });
    std::copy_n(replayed.begin(), camera_samples.size(), records.begin());
    return rejected;
}

std::size_t trace_radiance(const TraceInput& input, std::span<const BatchSample> samples,
                           std::span<Rgbf> radiance) {
    check(input, samples);
    if (has_bounces(*input.scene->scene)) {
        trace_bounces(input, samples, radiance);
        return leave_out_non_finite(radiance);
    }
    return trace_direct(input, samples, radiance,
                        [&](const TraceWorkspace& w, Technique, std::size_t i, const Rgbf& value) {
                            radiance[w.points.sample[i]] += value;
                        });
}

}  // namespace burnish
