#include "optimize/without_effect.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>
#include <utility>
#include <variant>

#include "core/count_of.h"
#include "core/variant.h"
#include "gradient/estimator.h"
#include "gradient/path_cache/path_cache.h"
#include "optimize/search_again.h"
#include "optimize/search_plan.h"
#include "texture/pyramid.h"

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

/// Levels of a texture, of which the coarsest is one texel.
int most_levels(const Bitmap& bitmap) {
    constexpr int kAll = std::numeric_limits<int>::max();
    return static_cast<int>(make_maps(kAll, bitmap.width, bitmap.height, {}, false).sizes.size());
}

/// More levels than the textures have; those of one texel have one, which does not decay.
std::vector<std::string> levels_without_effect(const Options& options, const Scene& scene,
                                               std::span<const TextureId> unknowns) {
    std::vector<std::string> sentences;
    if (options.parameterization != Parameterization::kPyramid || unknowns.empty())
        return sentences;
    int most = 1;
    for (const TextureId id : unknowns)
        most = std::max(most, most_levels(std::get<Bitmap>(scene[id])));
    const int levels = options.pyramid.levels;
    if (most > 1) {
        if (levels > most && levels != Pyramid{}.levels)
            sentences.push_back(
                fmt::format("pyramid.levels has no effect above {}, where a texel is the whole "
                            "texture: found {}",
                            most, levels));
        return sentences;
    }
    const auto say = [&](const char* name) {
        sentences.push_back(fmt::format("{} has no effect: every unknown is one texel", name));
    };
    if (levels != Pyramid{}.levels) say("pyramid.levels");
    if (options.pyramid.weight_decay != Pyramid{}.weight_decay) say("pyramid.weight_decay");
    return sentences;
}

/// Searches that no unknown has, or that the run ends before; empty: some come.
std::string searches_without_effect(const Options& options, const Scene& scene,
                                    const UnknownTextures& unknowns) {
    if (options.search_again == 0) return {};
    if (!may_search_again(scene, unknowns.searched))
        return "search_again has no effect: it needs a texture, not a constant, whose start is "
               "searched and whose material has no colour or constant that is searched";
    const std::uint32_t first = first_search(options), last = effective_stop(options).iterations;
    if (last > first) return {};
    return fmt::format(
        "search_again has no effect in {}: the first search comes after {}, a quarter of {}",
        count_of(last, "iteration"), first, options.search_again);
}

}  // namespace

std::vector<std::string> options_without_effect(const Options& options, const Scene& scene,
                                                const UnknownTextures& unknowns,
                                                std::size_t fitted) {
    std::vector<std::string> sentences = levels_without_effect(options, scene, unknowns.all);
    for (const std::string& text : {samples_without_effect(options.estimator),
                                    searches_without_effect(options, scene, unknowns)})
        if (!text.empty()) sentences.push_back(text);
    if (options.batch > 1 && options.batch > fitted)
        sentences.push_back(fmt::format(
            "batch has no effect above {}, the number of views that are fitted: found {}", fitted,
            options.batch));
    return sentences;
}

}  // namespace burnish
