#include "cli/contributions.h"

#include <fmt/format.h>

#include <algorithm>

namespace burnish {

namespace {

bool same_place(const Outlier& a, const Outlier& b) {
    return a.pixel == b.pixel && a.slot == b.slot && a.texel == b.texel &&
           a.technique == b.technique;
}

}  // namespace

void add_counts(ContributionCounts& counts, const GradientCounts& more, std::uint32_t iteration) {
    counts.records += more.records;
    counts.candidates += more.candidates;
    counts.rejected += more.rejected;
    for (const Outlier& e : more.outliers) counts.outliers.push_back({e, iteration});
    std::stable_sort(counts.outliers.begin(), counts.outliers.end(),
                     [](const NamedOutlier& a, const NamedOutlier& b) {
                         return a.contribution.value > b.contribution.value;
                     });
    std::vector<NamedOutlier> kept;
    for (const NamedOutlier& e : counts.outliers)
        if (kept.size() < kMaxOutliers &&
            std::none_of(kept.begin(), kept.end(),
                         [&](const auto& k) { return same_place(k.contribution, e.contribution); }))
            kept.push_back(e);
    counts.outliers = std::move(kept);
}

std::string describe(const NamedOutlier& outlier, const Scene& scene, const Theta& theta) {
    const Outlier& e = outlier.contribution;
    const auto film_width = static_cast<std::uint32_t>(scene.film.crop_width);
    const ThetaTexture& t = theta.textures[e.slot];
    const auto width = static_cast<std::uint32_t>(t.values.width);
    return fmt::format(
        "{:.3g} at pixel ({}, {}) to texel ({}, {}) of {} by the {} technique in "
        "iteration {}",
        e.value, e.pixel % film_width, e.pixel / film_width, e.texel % width, e.texel / width,
        parameter_name(scene, t.texture), name_of(e.technique), outlier.iteration);
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
