#include "cli/run_evidence.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/console.h"
#include "cli/progress.h"
#include "core/joined.h"
#include "optimize/exposure.h"
#include "optimize/loss.h"
#include "optimize/views.h"
#include "render/renderer.h"

namespace burnish {

namespace {

/// Of the squared difference of the channels of a view's image in the loss.
Image loss_weights(const RunResult& run, const View& view) {
    const ExposureFactors exposure = factors_of(view.exposure);  // of the truth
    Image one_off = view.image;
    for (float& v : one_off.values) v += 1;
    const Loss loss = run.settings.options.loss;
    Image weights = evaluate_loss(loss, one_off, view.image, view.mask).adjoint;
    for (std::size_t i = 0; i < weights.values.size(); ++i)
        weights.values[i] *= exposure[i % 3] * exposure[i % 3];
    return weights;
}

}  // namespace

void find_evidence(RunResult& run) {
    const auto fitted = static_cast<std::uint32_t>(fitted_count(run));
    const std::uint32_t passes = 2 * std::clamp(64 / std::max(fitted, 1u), 1u, 8u);  // of each view
    Theta truth;
    for (const TargetTexture& t : run.textures) truth.textures.push_back({t.texture, *t.truth});
    std::vector<TexelEvidence> evidence;
    ProgressLine line("finding the texels that light reaches");
    for (std::size_t v = 0; v < run.views.size(); ++v) {
        if (run.views[v].held_out) continue;
        const Progress progress = [&](double share) {
            line.show_share((static_cast<double>(v) + share) /
                            static_cast<double>(run.views.size()));
        };
        add(texel_evidence(run.renderers[v].data().traced, truth, loss_weights(run, run.views[v]),
                           seed_of_view(run.settings.options.seed, v), passes, progress),
            evidence);
    }
    for (std::size_t i = 0; i < run.textures.size(); ++i) {
        TargetTexture& t = run.textures[i];
        t.evidence = std::move(evidence[i]);
        run.initial_errors.push_back(errors_of(t, t.initial));
    }
}

void warn_of_unseen(RunResult& run) {
    const auto warn = [&](std::string text) {
        run.picture_warnings.push_back(std::move(text));
        log_warning(run.picture_warnings.back());
    };
    const auto is_seen = [&](std::size_t i) {
        const std::vector<float>& coverage = run.result.summary.textures[i].coverage.values;
        return std::ranges::any_of(coverage, [](float share) { return share > 0; });
    };
    const std::vector<SearchedGroup>& groups = run.result.summary.searched;
    const bool is_alone = groups.size() == 1 && groups[0].unknowns.size() == 1;
    const auto is_unknown = [](const SearchedValues& v) { return v.regions == 0; };
    for (const SearchedGroup& g : groups)
        if (std::ranges::all_of(g.tried, is_unknown) && std::ranges::any_of(g.unknowns, is_seen)) {
            const std::string names =
                joined(g.unknowns, [&](std::size_t u) { return run.textures[u].name; });
            warn("no part of a picture " +
                 (is_alone ? "tells where " + names + " starts"
                           : "shows " + names + " without other textures that are searched") +
                 ": the start is 0.5");
        }
    for (std::size_t i = 0; i < run.textures.size(); ++i)
        if (!is_seen(i))
            warn("no light that a picture shows came from " + run.textures[i].name +
                 ": it is as it started");
}

}  // namespace burnish
