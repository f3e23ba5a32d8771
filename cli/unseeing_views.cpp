#include "cli/unseeing_views.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "burnish/error.h"
#include "cli/console.h"
#include "cli/inspect.h"
#include "core/joined.h"
#include "core/parallel.h"
#include "gradient/theta.h"
#include "optimize/views.h"
#include "render/renderer.h"
#include "render/visible_pixels.h"

namespace burnish {

namespace {

bool is_any(const std::vector<char>& pixels) {
    return std::find(pixels.begin(), pixels.end(), 1) != pixels.end();
}

/// Where light bounces, any surface may show the light of an unknown. reaching: reaching_pixels of
/// the view; null: not known. bsdfs: non-zero of unknowns.
bool can_show(const TracedScene& view, const std::vector<char>* reaching,
              const std::vector<char>& bsdfs) {
    if (!has_bounces(*view.scene))
        return is_any(reaching ? *reaching : visible_pixels(view, bsdfs));
    return shows_a_shape(view) || is_any(visible_pixels(view, std::vector<char>(bsdfs.size(), 1)));
}

std::string names_of_unknowns(const RunResult& run) {
    return joined(run.textures, &TargetTexture::name);
}

}  // namespace

void find_unseeing_views(const Theta& theta, std::span<const std::vector<char>> reaching,
                         RunResult& run) {
    std::vector<const std::vector<char>*> known;
    std::size_t fitted = 0;
    for (const CapturedView& source : run.sources)
        known.push_back(source.view.held_out ? nullptr : &reaching[fitted++]);
    std::vector<char> sees(run.renderers.size());
    parallel_tasks(sees.size(), [&](std::size_t i) {
        const TracedScene& traced = run.renderers[i].data().traced;
        sees[i] = can_show(traced, known[i], unknown_bsdfs(*traced.scene, theta));
    });
    bool is_fitted = false;
    for (std::size_t i = 0; i < sees.size(); ++i)
        if (!sees[i])
            run.unseeing_views.push_back(i);
        else if (!run.sources[i].view.held_out)
            is_fitted = true;
    if (!is_fitted)
        throw InputError(fmt::format(
            "no view that is fitted sees {}: expected a camera that looks at a shape with "
            "its material, in the same units and axes",
            names_of_unknowns(run)));
}

std::string unseeing_text(const RunResult& run) {
    if (run.unseeing_views.empty()) return {};
    std::vector<std::string> names;
    for (const std::size_t i : run.unseeing_views) names.push_back(name_of(run.sources[i].view, i));
    return fmt::format(
        "no pixel of {} can show {}: expected cameras in the units and axes of the scene",
        views_text(std::move(names)), names_of_unknowns(run));
}

std::string views_text(std::vector<std::string> names) {
    constexpr std::size_t kNamed = 3;
    const std::size_t others = names.size() - std::min(names.size(), kNamed);
    names.resize(names.size() - others);
    std::string text = fmt::format("{}", fmt::join(names, ", "));
    if (others > 0) text += " and " + count_text(others, "other view");
    return text;
}

}  // namespace burnish
