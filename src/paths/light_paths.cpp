#include "paths/light_paths.h"

#include <cmath>

namespace burnish {

namespace {

/// Positive wherever there is light: some channels of a sky may be negative.
double magnitude(const Rgbf& v) {
    return std::abs(double{v.x}) + std::abs(double{v.y}) + std::abs(double{v.z});
}

/// The end of a path.
struct PathEnd {
    std::size_t last = 0;
    Technique technique = Technique::kBsdf;
};

/// Calls body(end, what it brings) for the terms of P_k (D_k + C_k R_{k+1}). before: P_k.
void for_paths_behind(std::span<const ChainVertex> chain, std::size_t k, const Rgbf& before,
                      const auto& body) {
    body(PathEnd{k, Technique::kBsdf}, before * chain[k].gathered);
    Rgbf throughput = before * chain[k].onward;
    for (std::size_t j = k + 1; j < chain.size(); ++j) {
        const ChainVertex& v = chain[j];
        body(PathEnd{j, Technique::kEmitter}, throughput * v.f_light * v.emitted);
        body(PathEnd{j, Technique::kBsdf}, throughput * v.f_next * v.gathered);
        throughput = throughput * v.f_next * v.onward;
    }
}

struct ChosenEnd {
    PathEnd end;
    double probability = 0;  ///< 0: none brings light
};

/// u: uniform in [0, 1).
ChosenEnd choose_end(std::span<const ChainVertex> chain, std::size_t k, const Rgbf& before,
                     float u) {
    double all = 0;
    for_paths_behind(chain, k, before, [&](const PathEnd&, const Rgbf& b) { all += magnitude(b); });
    if (!(all > 0)) return {{}, std::isnan(all) ? all : 0};
    ChosenEnd chosen;
    double left = double{u} * all;
    for_paths_behind(chain, k, before, [&](const PathEnd& end, const Rgbf& b) {
        const double share = magnitude(b);
        if (!(share > 0) || left < 0) return;
        chosen = {end, share / all};
        left = left < share ? -1 : left - share;
    });
    return chosen;
}

/// K: all of a path but its f.
Rgbf constant_of(std::span<const ChainVertex> chain, const PathEnd& end) {
    Rgbf constant{1, 1, 1};
    for (std::size_t j = 0; j < end.last; ++j) constant = constant * chain[j].onward;
    const ChainVertex& last = chain[end.last];
    return constant * (end.technique == Technique::kEmitter ? last.emitted : last.gathered);
}

const Vec3f& wo_of(const ChainVertex& v, Technique technique) {
    return technique == Technique::kEmitter ? v.wo_light : v.wo_next;
}

/// Calls body(vertex, technique of its direction) for those of a path but that of its record.
void for_others(std::span<const ChainVertex> chains, const ChainPlace& place, const auto& body) {
    for (std::uint32_t j = place.begin; j <= place.last; ++j)
        if (j != place.vertex)
            body(chains[j], j == place.last ? place.technique : Technique::kBsdf);
}

/// The paths of one chain.
struct ChainPaths {
    const TraceInput& input;
    const CameraSample& camera;
    const Chain& chain;
    std::span<const ChainVertex> vertices;

    /// That ends so, differentiated at vertex k.
    LightPath path(std::size_t k, const PathEnd& end, double probability) const {
        const ChainVertex& v = vertices[k];
        const Technique technique = k == end.last ? end.technique : Technique::kBsdf;
        const auto index = [&](std::size_t j) {
            return chain.begin + static_cast<std::uint32_t>(j);
        };
        return {chain.sample,
                {camera.pixel, technique, v.bsdf, film_pass(camera, input.passes_per_iteration),
                 v.uv, v.wi, wo_of(v, technique),
                 constant_of(vertices, end) * static_cast<float>(1 / probability)},
                {index(0), index(k), index(end.last), end.technique}};
    }
};

}  // namespace

void append(PathVertices& paths, std::span<const PathVertex> vertices) {
    paths.vertices.insert(paths.vertices.end(), vertices.begin(), vertices.end());
    paths.ends.push_back(static_cast<std::uint32_t>(paths.vertices.size()));
}

void append(PathVertices& paths, const PathVertices& more) {
    const auto first = static_cast<std::uint32_t>(paths.vertices.size());
    paths.vertices.insert(paths.vertices.end(), more.vertices.begin(), more.vertices.end());
    for (const std::uint32_t end : more.ends) paths.ends.push_back(first + end);
}

std::size_t append_light_paths(const TraceInput& input, std::span<const BatchSample> samples,
                               const ChainOutput& chains, std::vector<LightPath>& out) {
    std::size_t rejected = 0;
    for (const Chain& chain : chains.chains) {
        const CameraSample& camera = samples[static_cast<std::size_t>(chain.sample)].camera;
        const auto vertices =
            std::span(chains.vertices).subspan(chain.begin, chain.end - chain.begin);
        const ChainPaths paths{input, camera, chain, vertices};
        const auto add = [&](std::size_t k, const PathEnd& end, double probability) {
            if (probability == 0) return;
            const LightPath path = paths.path(k, end, probability);
            if (is_finite(path.record.radiance_over_pdf))
                out.push_back(path);
            else
                ++rejected;
        };
        Rgbf before{1, 1, 1};  // P_k
        for (std::size_t k = 0; k < vertices.size() && !is_black(before); ++k) {
            const ChainVertex& v = vertices[k];
            add(k, {k, Technique::kEmitter}, is_black(v.emitted) ? 0 : 1);
            const float u = uniforms(input.key, camera.pixel, camera.iteration, camera.pass,
                                     kLightChoiceNumbers | static_cast<std::uint32_t>(k))[0];
            const ChosenEnd chosen = choose_end(vertices, k, before, u);
            add(k, chosen.end, chosen.probability);
            before = before * v.f_next * v.onward;
        }
    }
    return rejected;
}

void append_others(std::span<const ChainVertex> chains, const ChainPlace& place,
                   std::vector<PathVertex>& others) {
    for_others(chains, place, [&](const ChainVertex& v, Technique technique) {
        others.push_back({v.bsdf, v.uv, v.wi, wo_of(v, technique)});
    });
}

Rgbf scattered_by_others(std::span<const ChainVertex> chains, const ChainPlace& place) {
    Rgbf product{1, 1, 1};
    for_others(chains, place, [&](const ChainVertex& v, Technique technique) {
        product = product * (technique == Technique::kEmitter ? v.f_light : v.f_next);
    });
    return product;
}

}  // namespace burnish
