#include "cli/without_effect.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/console.h"
#include "optimize/search_plan.h"

namespace burnish {

void warn_without_effect(const Scene& scene, const RunResult& run) {
    const Options& options = run.settings.options;
    std::vector<TextureId> searched;
    for (const TargetTexture& t : run.textures)
        if (t.start_kind == StartKind::kSearched) searched.push_back(t.texture);
    if (options.search_again > 0 && !may_search_again(scene, searched))
        log_warning(
            "search_again has no effect: it needs a texture, not a constant, whose start is "
            "searched "
            "and whose material has no colour or constant that is searched");
    const bool has_pictures =
        std::ranges::none_of(run.sources, [](const CapturedView& v) { return v.image.empty(); });
    if (run.settings.run.target_samples != RunSettings{}.target_samples && has_pictures)
        log_warning(
            "--target-spp (problem.target_samples) has no effect: every view has a picture");
    const std::size_t fitted = fitted_count(run);
    if (options.batch > 1 && options.batch > fitted)
        log_warning(fmt::format(
            "batch has no effect above {}, the number of views that are fitted: found {}", fitted,
            options.batch));
}

}  // namespace burnish
