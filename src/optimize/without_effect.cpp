#include "optimize/without_effect.h"

#include <fmt/format.h>

#include "optimize/search_plan.h"

namespace burnish {

std::vector<std::string> options_without_effect(const Options& options, const Scene& scene,
                                                std::span<const TextureId> searched,
                                                std::size_t fitted) {
    std::vector<std::string> sentences;
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
