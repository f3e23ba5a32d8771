#include "cli/without_effect.h"

#include <algorithm>

#include "cli/console.h"
#include "optimize/without_effect.h"

namespace burnish {

void warn_without_effect(const Scene& scene, const RunResult& run) {
    std::vector<TextureId> searched;
    for (const TargetTexture& t : run.textures)
        if (t.start_kind == StartKind::kSearched) searched.push_back(t.texture);
    for (const std::string& sentence :
         options_without_effect(run.settings.options, scene, searched, fitted_count(run)))
        log_warning(sentence);
    const bool has_pictures =
        std::ranges::none_of(run.sources, [](const CapturedView& v) { return v.image.empty(); });
    if (run.settings.run.target_samples != RunSettings{}.target_samples && has_pictures)
        log_warning(
            "--target-spp (problem.target_samples) has no effect: every view has a picture");
}

}  // namespace burnish
