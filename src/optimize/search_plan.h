// What a search for the start tries, and with how many samples.
#pragma once

#include "optimize/search_view.h"

namespace burnish {

/// A run searches no more of its views, spread evenly, and no more does patience check.
inline constexpr std::size_t kMaxSearchViews = 16;
/// Of `count` views those that a run searches and checks.
std::vector<std::size_t> searched_views(std::size_t count);

/// A texture whose start is searched.
struct SearchUnknown {
    TextureId texture;
    const ChartMap& charts;
    std::vector<TextureId> guides;  ///< see guides_of
};

/// The largest weight of the pixels that may see an unknown, over all views: SearchView::max_mask.
/// 1 where no such pixel counts. views: of one scene.
float max_mask(std::span<const SearchView> views, const std::vector<TextureId>& unknowns);

/// Groups with their regions and candidates; squares and passes so that the work stays within a
/// bound, whatever the views. views: at least one, of one scene. effort: times that bound.
SearchPlan make_search_plan(std::span<const SearchView> views,
                            std::span<const SearchUnknown> unknowns, std::uint32_t seed,
                            double effort = 1);

/// Whether a run may search the group again (Options::search_again): numbers of several texels, for
/// which costs alone tell regions apart.
bool may_search_again(const SearchGroup& group);
/// Whether a search has such a group. unknowns: whose start is searched.
bool may_search_again(const Scene& scene, std::span<const TextureId> unknowns);

/// The candidates of one number among so many that are searched together. A roughness has ten,
/// dense where highlights change most; another number has eleven alone, three beside others.
std::vector<float> candidate_grid(bool is_roughness, std::size_t numbers);

}  // namespace burnish
