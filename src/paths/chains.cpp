#include "paths/chains.h"

#include <algorithm>

namespace burnish {

namespace {

/// R_k from R_{k+1}.
Rgbf scattered(const ChainVertex& v, const Rgbf& rest) {
    return v.f_light * v.emitted + v.f_next * (v.gathered + v.onward * rest);
}

bool carries_light(const ChainVertex& v) {
    return !is_black(v.emitted) || !is_black(v.gathered) || !is_black(v.onward);
}

bool is_finite_vertex(const ChainVertex& v) {
    return is_finite(v.emitted) && is_finite(v.gathered) && is_finite(v.onward) &&
           is_finite(v.f_light) && is_finite(v.f_next);
}

/// Makes a chain of the vertices from `begin` on; those behind the last one that light reaches are
/// left out.
void end_chain(std::uint32_t begin, ChainOutput& out) {
    const auto first = out.vertices.begin() + begin;
    if (!std::all_of(first, out.vertices.end(), is_finite_vertex)) {
        ++out.rejected;
        out.vertices.resize(begin);
    }
    while (out.vertices.size() > begin && !carries_light(out.vertices.back())) {
        out.vertices.pop_back();
        if (out.vertices.size() > begin) out.vertices.back().onward = {};
    }
    if (out.vertices.size() > begin)
        out.chains.push_back(
            {out.vertices[begin].sample, begin, static_cast<std::uint32_t>(out.vertices.size())});
}

/// From the order of bounces to that of samples, within which bounces stay in order.
void make_chains(std::span<const ChainVertex> traced, std::size_t samples, ChainOutput& out) {
    std::vector<std::uint32_t> end(samples + 1, 0), order(traced.size());
    for (const ChainVertex& v : traced) ++end[static_cast<std::size_t>(v.sample) + 1];
    for (std::size_t s = 0; s < samples; ++s) end[s + 1] += end[s];
    std::vector<std::uint32_t> next(end.begin(), end.end() - 1);
    for (std::size_t i = 0; i < traced.size(); ++i)
        order[next[static_cast<std::size_t>(traced[i].sample)]++] = static_cast<std::uint32_t>(i);
    for (std::size_t s = 0; s < samples; ++s) {
        const auto begin = static_cast<std::uint32_t>(out.vertices.size());
        for (std::uint32_t k = end[s]; k < end[s + 1]; ++k)
            out.vertices.push_back(traced[order[k]]);
        end_chain(begin, out);
    }
}

}  // namespace

void trace_chains(const TraceInput& input, std::span<const BatchSample> samples, ChainOutput& out) {
    out.emitted.resize(samples.size());
    out.chains.clear(), out.vertices.clear();
    thread_local std::vector<ChainVertex> vertices;  // scratch memory only
    vertices.clear();
    trace_vertices(input, samples, out.emitted, vertices);
    out.rejected = leave_out_non_finite(out.emitted);
    make_chains(vertices, samples.size(), out);
}

Rgbf value_of(std::span<const ChainVertex> chain) {
    Rgbf value;
    for (auto v = chain.rbegin(); v != chain.rend(); ++v) value = scattered(*v, value);
    return value;
}

std::size_t append_samples(const TraceInput& input, std::span<const BatchSample> samples,
                           const ChainOutput& chains, std::vector<DirectSample>& out) {
    std::size_t rejected = 0;
    std::vector<Rgbf> rest;  // R behind each vertex
    for (const Chain& chain : chains.chains) {
        const std::span<const ChainVertex> vertices =
            std::span(chains.vertices).subspan(chain.begin, chain.end - chain.begin);
        rest.assign(vertices.size(), {});
        for (std::size_t k = vertices.size() - 1; k > 0; --k)
            rest[k - 1] = scattered(vertices[k], rest[k]);
        Rgbf before{1, 1, 1};  // throughput from the camera to a vertex
        const auto s = static_cast<std::size_t>(chain.sample);
        for (std::size_t k = 0; k < vertices.size(); ++k) {
            const ChainVertex& v = vertices[k];
            const auto add = [&](Technique technique, const Vec3f& wo, const Rgbf& f,
                                 const Rgbf& light) {
                const Rgbf value = f * light;
                if (is_black(light) || (is_black(value) && !input.keep_black)) return;
                if (!is_finite(value) || !is_finite(light)) {
                    ++rejected;
                    return;
                }
                const PathRecord record{samples[s].camera.pixel,
                                        technique,
                                        v.bsdf,
                                        film_pass(samples[s].camera, input.passes_per_iteration),
                                        v.uv,
                                        v.wi,
                                        wo,
                                        light};
                out.push_back({chain.sample, static_cast<std::uint16_t>(k), record, value, true});
            };
            add(Technique::kEmitter, v.wo_light, v.f_light, before * v.emitted);
            add(Technique::kBsdf, v.wo_next, v.f_next, before * (v.gathered + v.onward * rest[k]));
            before = before * v.f_next * v.onward;
        }
    }
    return rejected;
}

}  // namespace burnish
