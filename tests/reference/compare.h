// What the tests of the fast code against the reference share.
#pragma once

#include <algorithm>
#include <cmath>

#include "gradient/texel_gradient.h"
#include "images.h"
#include "reference/pgris.h"
#include "worst.h"

namespace burnish::test {

/// The same numbers by texels.
inline reference::Gradient by_texel(const std::vector<TexelGradient>& gradient) {
    reference::Gradient all;
    for (const TexelGradient& t : gradient) all[{t.key.slot, t.key.texel}] = t.g;
    return all;
}

/// The largest difference of two gradients, relative to the largest entry of b.
inline double difference(const reference::Gradient& a, const reference::Gradient& b) {
    double worst = 0, largest = 0;
    const auto at = [](const reference::Gradient& g, reference::Texel i) {
        const auto found = g.find(i);
        return found == g.end() ? Rgbf{} : found->second;
    };
    const auto norm = [](const Rgbf& v) { return std::sqrt(double{dot(v, v)}); };
    for (const auto* g : {&a, &b})
        for (const auto& [i, v] : *g) {
            worst = test::worse(worst, norm(at(a, i) - at(b, i)));
            largest = std::max(largest, norm(at(b, i)));
        }
    return worst / largest;
}

/// Calls body(x) for all paths of an iteration's derivative.
inline void for_each_path(const reference::World& world, const reference::RandomStream& stream,
                          std::uint32_t v, const auto& body) {
    const Film& film = world.scene().film;
    const auto pixels = static_cast<std::uint32_t>(film.crop_width * film.crop_height);
    for (std::uint32_t k = 0; k < stream.m; ++k)
        for (const Technique technique : {Technique::kEmitter, Technique::kBsdf})
            for (std::uint32_t j = 0; j < pixels; ++j) {
                const PathSample sample{{j, v, k}, technique};
                body(make_path(world, sample, numbers_of(stream, sample)));
            }
}

/// The baseline: the plain sum over the paths of iteration v.
inline reference::Gradient monte_carlo(const TracedScene& traced, const reference::Integrand& now,
                                       const reference::RandomStream& stream, std::uint32_t v) {
    const reference::World world{traced, now.pi};
    reference::Gradient gradient;
    for_each_path(world, stream, v, [&](const reference::Path& x) {
        for (const auto& [i, d] : derivatives(world, now.adjoint, x))
            gradient[i] += d.g * (1 / static_cast<float>(stream.m));
    });
    return gradient;
}

/// Whether weights of blends are all that is unknown: then f is within the light of a record.
inline bool is_within_light(const reference::World& world, BsdfId bsdf) {
    const auto is_unknown = [&](TextureId t) { return world.slot(t) >= 0; };
    return std::ranges::none_of(textures_of(world.scene()[bsdf]), is_unknown) &&
           std::ranges::any_of(shares_of(world.scene(), bsdf), is_unknown, &BlendShare::weight);
}

/// A record of the fast code, as the reference has it.
inline reference::Path path_of(const reference::World& world, const PathRecord& r,
                               const Vec2f& film) {
    return {.sample = {{r.pixel, 0, 0}, r.technique},
            .film = film,
            .bsdf = r.bsdf,
            .uv = r.uv,
            .wi = r.wi_local,
            .wo = r.wo_local,
            .light = r.radiance_over_pdf,
            .delta = is_within_light(world, r.bsdf),
            .lobe = {1, 1, 1}};
}

}  // namespace burnish::test
