#include "optimize/without_effect.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>
#include <variant>

#include "core/variant.h"
#include "gradient/estimator.h"
#include "gradient/path_cache/path_cache.h"
#include "optimize/search_plan.h"

namespace burnish {

namespace {

/// More fresh samples than a path cache keeps; empty: there are none.
std::string samples_without_effect(const Estimator& estimator) {
    const std::optional<KeptCache> kept = kept_cache(estimator);
    if (!kept) return {};
    const PathCache& cache = kept->options;
    const std::uint32_t max = fresh_passes(cache.samples, cache.window);
    if (cache.samples == max) return {};
    const char* names = match(
        estimator, [](const PathCache&) { return "path_cache."; },
        [](const MonteCarlo&) { return "monte_carlo.image_"; },
        [](const Reservoirs&) { return "reservoirs.image_"; });
    return fmt::format("{0}samples has no effect above {1}, twice {0}window: found {2}", names, max,
                       cache.samples);
}

/// A texture of one texel has one level, which does not decay.
std::vector<std::string> levels_without_effect(const Options& options, const Scene& scene,
                                               std::span<const TextureId> unknowns) {
    const auto is_one_texel = [&](TextureId id) {
        const auto& bitmap = std::get<Bitmap>(scene[id]);
        return bitmap.width == 1 && bitmap.height == 1;
    };
    std::vector<std::string> sentences;
    if (options.parameterization != Parameterization::kPyramid ||
        !std::ranges::all_of(unknowns, is_one_texel))
        return sentences;
    const auto say = [&](const char* name) {
        sentences.push_back(fmt::format("{} has no effect: every unknown is one texel", name));
    };
    if (options.pyramid.levels != Pyramid{}.levels) say("pyramid.levels");
    if (options.pyramid.weight_decay != Pyramid{}.weight_decay) say("pyramid.weight_decay");
    return sentences;
}

}  // namespace

std::vector<std::string> options_without_effect(const Options& options, const Scene& scene,
                                                const UnknownTextures& unknowns,
                                                std::size_t fitted) {
    std::vector<std::string> sentences = levels_without_effect(options, scene, unknowns.all);
    if (std::string text = samples_without_effect(options.estimator); !text.empty())
        sentences.push_back(std::move(text));
    if (options.search_again > 0 && !may_search_again(scene, unknowns.searched))
        sentences.push_back(
            "search_again has no effect: it needs a texture, not a constant, whose start is "
            "searched and whose material has no colour or constant that is searched");
    if (options.batch > 1 && options.batch > fitted)
        sentences.push_back(fmt::format(
            "batch has no effect above {}, the number of views that are fitted: found {}", fitted,
            options.batch));
    return sentences;
}

}  // namespace burnish
