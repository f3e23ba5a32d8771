#include "optimize/start_search.h"

#include <algorithm>
#include <cmath>

#include "core/stopwatch.h"
#include "optimize/option_table.h"
#include "optimize/search_bounces.h"
#include "optimize/search_choice.h"
#include "optimize/search_exposure.h"
#include "optimize/search_guide.h"

namespace burnish {

namespace {

/// A search takes 2 to 6 s of two threads beside a run of one minute; beside a longer one as large
/// a share.
double effort_of(const Options& options) {
    constexpr double kShortRun = 60;
    if (options.search_effort) return *options.search_effort;
    return std::isfinite(options.stop.seconds)
               ? std::clamp(options.stop.seconds / kShortRun, 1.0, kMaxSearchEffort)
               : 1;
}

std::vector<std::string> names_of(const Scene& scene, const std::vector<TextureId>& textures) {
    std::vector<std::string> names;
    for (const Parameter& p : scene.parameters)
        if (std::find(textures.begin(), textures.end(), p.texture) != textures.end())
            names.push_back(p.name);
    return names;
}

/// Tells the progress of what takes from `begin` to `end` of the whole.
Progress part_of(const Progress& progress, double begin, double end) {
    if (!progress) return {};
    return [&progress, begin, end](double share) { progress(begin + share * (end - begin)); };
}

bool has_color(const SearchPlan& plan) {
    return std::ranges::any_of(plan.groups,
                               [](const SearchGroup& g) { return g.color.has_value(); });
}

/// Half as many samples, of their own, tell the colours first.
std::vector<GroupSums> sum_views(const SearchPlan& plan, std::span<SearchFrame> frames,
                                 const Progress& progress) {
    std::vector<GroupSums> sums;
    for (const SearchGroup& g : plan.groups) sums.push_back(make_sums(g));
    const double of_colors = has_color(plan) ? 1.0 / 3 : 0;
    if (has_color(plan)) {
        draw_passes(frames, seed_of_half(plan.seed, 1), plan.passes / 2);
        add_colors(frames, sums, part_of(progress, 0, of_colors));
        draw_passes(frames, plan.seed, plan.passes);
    }
    std::vector<GroupColors> colors;
    for (std::size_t g = 0; g < plan.groups.size(); ++g)
        colors.push_back(choose_colors({plan, plan.groups[g], sums[g]}));
    add_views(frames, colors, sums, part_of(progress, of_colors, 1));
    return sums;
}

}  // namespace

FoundStarts search_starts(std::span<const SearchView> views,
                          std::span<const SearchUnknown> unknowns, std::uint32_t seed,
                          double effort, const Progress& progress, const Theta& others) {
    const Scene& scene = *views.front().scene.scene;
    SearchPlan plan = make_search_plan(views, unknowns, seed, effort);
    plan.others = &others;
    const std::vector<SearchView> exposed = with_exposures(plan, views);
    std::vector<SearchFrame> frames = make_search_frames(plan, exposed);
    FoundStarts found{std::vector<Image>(unknowns.size()), {}, sum_views(plan, frames, progress)};
    for (std::size_t g = 0; g < plan.groups.size(); ++g) {
        const SearchGroup& group = plan.groups[g];
        GroupChoice choice = choose({plan, group, found.sums[g]}, scene);
        for (std::size_t m = 0; m < choice.starts.size(); ++m)
            found.textures[group.members[m]] = std::move(choice.starts[m]);
        found.groups.push_back(describe(choice));
        found.groups.back().guides = names_of(scene, group.guides);
        if (!may_search_again(group)) found.sums[g] = {};
    }
    if (has_bounces(scene) && has_color(plan)) draw_back_colors(frames, found.textures);
    return found;
}

SearchInput search_input(const Setup& setup) {
    SearchInput input;
    std::vector<TextureId> recovered;
    for (const UnknownTexture& u : setup.unknowns) recovered.push_back(u.texture);
    for (std::size_t i = 0; i < setup.unknowns.size(); ++i) {
        const UnknownTexture& u = setup.unknowns[i];
        if (u.start_kind != StartKind::kSearched) continue;
        input.unknowns.push_back(
            {u.texture, u.charts, guides_of(scene_of(setup), u.texture, recovered)});
        input.indices.push_back(i);
    }
    input.fitted = searched_views(setup.fitted.size());
    for (const std::size_t i : input.fitted) {
        const View& v = setup.problem.views[setup.fitted[i]];
        input.views.push_back(
            {scene_of(setup, setup.fitted[i]), v.image, v.mask, v.exposure, setup.max_mask});
    }
    return input;
}

Theta unsearched(const Setup& setup, const Theta* theta) {
    Theta others;
    for (std::size_t i = 0; i < setup.unknowns.size(); ++i) {
        const UnknownTexture& u = setup.unknowns[i];
        if (u.start_kind != StartKind::kSearched)
            others.textures.push_back(
                {u.texture, copy_of(theta ? theta->textures[i].values : u.start)});
    }
    return others;
}

SearchReport find_starts(Setup& setup, const Progress& progress) {
    const Stopwatch watch;
    const SearchInput input = search_input(setup);
    if (input.unknowns.empty()) return {};
    const double effort = effort_of(setup.options);
    FoundStarts found = search_starts(input.views, input.unknowns, setup.options.seed, effort,
                                      progress, unsearched(setup));
    for (std::size_t k = 0; k < input.indices.size(); ++k)
        setup.unknowns[input.indices[k]].start = std::move(found.textures[k]);
    for (SearchedGroup& g : found.groups)
        for (std::size_t& u : g.unknowns) u = input.indices[u];
    return {watch.total(), std::move(found.groups), std::move(found.sums), effort};
}

}  // namespace burnish
