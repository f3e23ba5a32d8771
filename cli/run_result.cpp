#include "cli/run_result.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "cli/console.h"
#include "image/quality.h"
#include "optimize/evaluation.h"
#include "optimize/view_loss.h"

namespace burnish {

TextureErrors errors_of(const TargetTexture& texture, const Image& texels) {
    const Image& truth = *texture.truth;
    return {texture_error(texels, truth, texture.evidence.visited),
            weighted_texture_error(texels, truth, texture.evidence.sensitivity)};
}

std::string error_text(double error, int decimals) {
    return std::isfinite(error) ? fmt::format("{:.{}f}", error, decimals) : "not known";
}

std::string halves_text(std::uint32_t window) {
    return "two halves of up to " + count_text(window, "pass", "passes");
}

std::string values_text(const Image& texels) {
    return fmt::format("{:.4g}", fmt::join(texels.values, ", "));
}

bool is_too_noisy(const Evaluation& result) {
    constexpr double kUncertainty = 0.05;
    return std::isfinite(result.noise_floor) &&
           loss_without_noise(result) < kUncertainty * result.noise_floor;
}

double similarity_of(const RunResult& run, std::size_t view) {
    const View& v = run.views[view];
    Theta theta;
    for (const TargetTexture& t : run.textures) theta.textures.push_back({t.texture, {}});
    const Compared compared = compared_in(run.renderers[view].data().traced, theta, v.mask);
    const ViewEvaluation& result = run.result.summary.result.views[view];
    const Image image = exposed(result.exposure, result.image);
    return ssim(image, alike_where_uncounted(v.image, image, v.mask),
                white_of(v.image, compared.values), compared.pixels);
}

Settings repeatable_settings(const RunResult& run) {
    Settings settings = run.settings;
    settings.options.stop.iterations = run.result.summary.counts.iterations;
    settings.options.stop.seconds = Stop{}.seconds;
    if (run.goes_on) settings.options.stop.patience = Stop{}.patience;
    settings.options.evaluation_samples = run.result.summary.result.samples_per_pixel;
    if (!run.result.summary.searched.empty())
        settings.options.search_effort = run.result.summary.search_effort;
    if (run.compared) {
        settings.run.compare_iterations = run.compared->summary.counts.iterations;
    } else {  // ended before the second run
        settings.run.compare.reset(), settings.compared.reset();
        settings.run.compare_iterations = 0;
    }
    return settings;
}

std::string ended_by(const Summary& summary) {
    return summary.ending == Ending::kCancelled ? "signal" : name_of(summary.ending);
}

std::string unvisited_text(const RunResult& run, std::size_t texture) {
    const RecoveredTexture& t = run.result.summary.textures[texture];
    if (t.unvisited == 0) return "";
    const bool is_one = t.unvisited == 1;
    std::string what =
        is_one ? "it is filled from those around it" : "they are filled from those around them";
    if (!t.filled) {
        what = is_one ? "it holds the start" : "they hold the start";
        if (!run.result.summary.searched_again.empty()) what += ", or what a later search chose";
    }
    return fmt::format("No sample of any view came to {} that surfaces read, of {} in all: {}.",
                       count_text(t.unvisited, "texel"), count_text(t.coverage.values.size()),
                       what);
}

std::vector<std::pair<std::string, const Image*>> evidence_maps(const RecoveredTexture& texture) {
    std::vector<std::pair<std::string, const Image*>> maps{{kCoverage, &texture.coverage}};
    if (texture.confidence.width > 0) maps.emplace_back(kConfidence, &texture.confidence);
    return maps;
}

}  // namespace burnish
