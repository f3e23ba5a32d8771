#include "optimize/without_effect.h"

#include <fmt/format.h>

#include <utility>

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
    const std::uint32_t most = fresh_passes(cache.samples, cache.window);
    if (cache.samples == most) return {};
    const char* names = match(
        estimator, [](const PathCache&) { return "path_cache."; },
        [](const MonteCarlo&) { return "monte_carlo.image_"; },
        [](const Reservoirs&) { return "reservoirs.image_"; });
    return fmt::format("{0}samples has no effect above {1}, twice {0}window: found {2}", names,
                       most, cache.samples);
}

}  // namespace

std::vector<std::string> options_without_effect(const Options& options, const Scene& scene,
                                                std::span<const TextureId> searched,
                                                std::size_t fitted) {
    std::vector<std::string> sentences;
    if (std::string text = samples_without_effect(options.estimator); !text.empty())
        sentences.push_back(std::move(text));
    if (options.search_again > 0 && !may_search_again(scene, searched))
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
