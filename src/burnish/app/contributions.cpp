#include "burnish/app/contributions.h"

#include <fmt/format.h>

#include <algorithm>

namespace burnish {

namespace {

bool same_place(const ExtremeContribution& a, const ExtremeContribution& b) {
    return a.pixel == b.pixel && a.slot == b.slot && a.texel == b.texel &&
           a.technique == b.technique;
}

}  // namespace

void add_counts(ContributionCounts& counts, const GradientCounts& more, std::uint32_t iteration) {
    counts.records += more.records;
    counts.candidates += more.candidates;
    counts.rejected += more.rejected;
    for (const ExtremeContribution& e : more.extremes) counts.extremes.push_back({e, iteration});
    std::stable_sort(counts.extremes.begin(), counts.extremes.end(),
                     [](const NamedExtreme& a, const NamedExtreme& b) {
                         return a.contribution.value > b.contribution.value;
                     });
    std::vector<NamedExtreme> kept;
    for (const NamedExtreme& e : counts.extremes)
        if (kept.size() < kExtremes && std::none_of(kept.begin(), kept.end(), [&](const auto& k) {
                return same_place(k.contribution, e.contribution);
            }))
            kept.push_back(e);
    counts.extremes = std::move(kept);
}

std::string describe(const NamedExtreme& extreme, const Scene& scene, const Theta& theta) {
    const ExtremeContribution& e = extreme.contribution;
    const auto film_width = static_cast<std::uint32_t>(scene.film.crop_width);
    const ThetaTexture& t = theta.textures[e.slot];
    const auto width = static_cast<std::uint32_t>(t.values.width);
    return fmt::format(
        "{:.3g} at pixel ({}, {}) to texel ({}, {}) of {} by the {} technique in "
        "iteration {}",
        e.value, e.pixel % film_width, e.pixel / film_width, e.texel % width, e.texel / width,
        parameter_name(scene, t.texture), name_of(e.technique), extreme.iteration);
}

std::string parameter_name(const Scene& scene, TextureId texture) {
    for (const Parameter& p : scene.parameters)
        if (p.texture == texture) return p.name;
    return {};
}

const char* name_of(Technique technique) {
    return technique == Technique::kEmitter ? "emitter" : "BSDF";
}

}  // namespace burnish
