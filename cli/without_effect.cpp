#include "cli/without_effect.h"

#include <algorithm>
#include <utility>

#include "cli/console.h"
#include "optimize/without_effect.h"

namespace burnish {

void warn_without_effect(const Scene& scene, const RunResult& run) {
    UnknownTextures unknowns;
    for (const TargetTexture& t : run.textures) {
        unknowns.all.push_back(t.texture);
        if (t.start_kind == StartKind::kSearched) unknowns.searched.push_back(t.texture);
    }
    const auto sentences_of = [&](const Options& options) {
        return options_without_effect(options, scene, unknowns, fitted_count(run));
    };
    std::vector<std::string> sentences = sentences_of(run.settings.options);
    if (run.settings.compared)
        for (std::string& sentence : sentences_of(*run.settings.compared))
            if (std::ranges::count(sentences, sentence) == 0)
                sentences.push_back(std::move(sentence));
    for (const std::string& sentence : sentences) log_warning(sentence);
    const bool has_pictures =
        std::ranges::none_of(run.sources, [](const CapturedView& v) { return v.image.empty(); });
    if (run.settings.run.target_samples != RunSettings{}.target_samples && has_pictures)
        log_warning(
            "--target-spp (problem.target_samples) has no effect: every view has a picture");
}

}  // namespace burnish
