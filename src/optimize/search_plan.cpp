#include "optimize/search_plan.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>

#include "core/parallel.h"
#include "gradient/theta.h"
#include "optimize/loss.h"
#include "optimize/search_guide.h"
#include "render/visible_pixels.h"

namespace burnish {

namespace {

constexpr std::size_t kMaxCandidates = 64;
/// The least and the most passes of each half where squares are pixels: with fewer, candidates
/// whose light is noisy win, and squares are enlarged.
constexpr double kPassesOfPixels = 12, kMaxPassesOfPixels = 32;
/// The least where squares are larger, and where numbers are beside colours.
constexpr double kPassesOfSquares = 32, kPassesBesideColors = 36;
/// The candidates of which these are the least passes; more need more, or noise lets one win.
constexpr double kFewCandidates = 11;
/// What a block of texels needs on average; beside colours its squares have one together.
constexpr double kSquaresOfBlock = 1.5, kSquaresBesideColors = 4, kSamplesOfBlock = 40;
/// Of tracing a camera sample, in units of shading it once; and of all.
constexpr double kTraceWork = 40, kMaxWork = 250.0 * (1 << 20);

/// How many texels another member has for each of a searched colour before regions are its: beside
/// colours regions need more squares.
constexpr int kTexelsOfColor = 8;

/// members: in the order in which they were asked for.
SearchGroup make_group(const Scene& scene, const SearchPlan& plan,
                       std::vector<std::size_t> members) {
    SearchGroup g;
    const auto bitmap = [&](std::size_t m) -> const Bitmap& {
        return std::get<Bitmap>(scene[plan.unknowns[m]]);
    };
    const auto is_uniform = [&](std::size_t m) {
        return bitmap(m).width == 1 && bitmap(m).height == 1;
    };
    std::optional<std::size_t> colored;
    for (const std::size_t m : members)
        if (plan.colors[m] && !colored) colored = m;
    g.gray = colored && bitmap(*colored).channels == 1;
    std::stable_partition(members.begin(), members.end(), std::not_fn(is_uniform));
    const auto finest = std::ranges::max_element(members, {}, [&](std::size_t m) {
        const std::int64_t texels = std::int64_t{bitmap(m).width} * bitmap(m).height;
        return is_uniform(m) ? 0 : texels * (m == colored ? kTexelsOfColor : 1);
    });
    std::rotate(members.begin(), finest, std::next(finest));
    if (colored)
        g.color = static_cast<std::size_t>(std::ranges::find(members, *colored) - members.begin());
    for (const std::size_t m : members) g.uniform.push_back(is_uniform(m));
    g.members = std::move(members);
    return g;
}

/// Sets of unknowns that a BSDF reads together, directly or through others.
std::vector<SearchGroup> make_groups(const Scene& scene, const SearchPlan& plan) {
    std::vector<std::size_t> group(plan.unknowns.size());
    for (std::size_t i = 0; i < group.size(); ++i) group[i] = i;
    for (std::size_t b = 0; b < scene.bsdfs.size(); ++b) {
        const auto read = textures_of(scene, BsdfId{static_cast<std::int32_t>(b)});
        std::optional<std::size_t> first;
        for (std::size_t i = 0; i < group.size(); ++i) {
            if (std::ranges::find(read, plan.unknowns[i]) == read.end()) continue;
            if (!first) first = i;
            const std::size_t low = std::min(group[*first], group[i]);
            const std::size_t high = std::max(group[*first], group[i]);
            std::replace(group.begin(), group.end(), high, low);
        }
    }
    std::vector<SearchGroup> groups;
    for (std::size_t first = 0; first < group.size(); ++first) {
        std::vector<std::size_t> members;
        for (std::size_t i = 0; i < group.size(); ++i)
            if (group[i] == first) members.push_back(i);
        if (!members.empty()) groups.push_back(make_group(scene, plan, std::move(members)));
    }
    return groups;
}

/// The unknowns in their groups; what is tried, and how often, comes later.
SearchPlan grouped(const Scene& scene, std::vector<TextureId> unknowns) {
    SearchPlan plan;
    for (const TextureId id : unknowns) plan.colors.push_back(read_as_color(scene, id));
    plan.unknowns = std::move(unknowns);
    plan.groups = make_groups(scene, plan);
    return plan;
}

/// The grid of each member. Numbers for which there is no room left stay in the middle: those that
/// were asked for last, constants first.
std::vector<std::vector<float>> make_grids(const Scene& scene, const SearchPlan& plan,
                                           const SearchGroup& group) {
    const auto is_number = [&](std::size_t place) { return !plan.colors[group.members[place]]; };
    std::vector<std::size_t> places(group.members.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    std::ranges::sort(places, {}, [&](std::size_t place) {
        return std::pair(group.uniform[place], group.members[place]);
    });
    const auto numbers = static_cast<std::size_t>(std::ranges::count_if(places, is_number));
    std::vector<std::vector<float>> grids(places.size(), {0.5f});
    std::size_t combinations = 1;
    for (const std::size_t place : places) {
        if (!is_number(place)) continue;
        const TextureId unknown = plan.unknowns[group.members[place]];
        std::vector<float> grid = candidate_grid(read_as_roughness(scene, unknown), numbers);
        if (combinations * grid.size() > kMaxCandidates) continue;
        combinations *= grid.size(), grids[place] = std::move(grid);
    }
    return grids;
}

/// All combinations.
std::vector<std::vector<float>> make_candidates(const Scene& scene, const SearchPlan& plan,
                                                const SearchGroup& group) {
    std::vector<std::vector<float>> candidates{{}};
    for (const std::vector<float>& grid : make_grids(scene, plan, group)) {
        std::vector<std::vector<float>> combined;
        for (const auto& c : candidates)
            for (const float v : grid) combined.push_back(c), combined.back().push_back(v);
        candidates = std::move(combined);
    }
    return candidates;
}

/// Pictures of a dark surface hardly tell whether it is metal: where they leave it open, it is not.
std::vector<float> make_prior_costs(const Scene& scene, const SearchPlan& plan,
                                    const SearchGroup& group) {
    constexpr float kMetal = 1;
    std::vector<float> costs(group.candidates.size());
    for (std::size_t m = 0; m < group.members.size(); ++m)
        if (group.color && read_as_metallic(scene, plan.unknowns[group.members[m]]))
            for (std::size_t k = 0; k < costs.size(); ++k)
                costs[k] += kMetal * group.candidates[k][m];
    return costs;
}

/// Pixels of all views that may see an unknown.
double count_seen(std::span<const SearchView> views, const SearchPlan& plan) {
    const Scene& scene = *views.front().scene.scene;
    const std::vector<char> unknown = unknown_bsdfs(scene, unknown_slots(scene, plan));
    double seen = 0;
    for (const SearchView& view : views) {
        const auto pixels = visible_pixels(view.scene, unknown);
        seen += static_cast<double>(std::count(pixels.begin(), pixels.end(), 1));
    }
    return seen;
}

/// The least side of squares of which so many passes over all pixels stay within the bound.
int scale_for(double pixels, double passes, double work) {
    return std::max(1,
                    static_cast<int>(std::ceil(std::sqrt(pixels * 2 * passes * work / kMaxWork))));
}

/// The least power of two with no more blocks.
int region_side(const Bitmap& bitmap, double blocks) {
    int side = 1;
    while (std::ceil(double{1} * bitmap.width / side) *
               std::ceil(double{1} * bitmap.height / side) >
           blocks)
        side *= 2;
    return side;
}

}  // namespace

std::vector<float> candidate_grid(bool is_roughness, std::size_t numbers) {
    if (is_roughness) return {0.02f, 0.05f, 0.08f, 0.12f, 0.18f, 0.25f, 0.35f, 0.5f, 0.7f, 0.9f};
    if (numbers > 1) return {0.0f, 0.5f, 1.0f};
    return {0.0f, 0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f, 0.7f, 0.8f, 0.9f, 1.0f};
}

bool may_search_again(const SearchGroup& group) {
    return !group.color && std::ranges::none_of(group.uniform, [](char u) { return u != 0; });
}

bool may_search_again(const Scene& scene, std::span<const TextureId> unknowns) {
    const SearchPlan plan = grouped(scene, {unknowns.begin(), unknowns.end()});
    return std::ranges::any_of(plan.groups,
                               [](const SearchGroup& g) { return may_search_again(g); });
}

std::vector<std::size_t> searched_views(std::size_t count) {
    std::vector<std::size_t> searched;
    const std::size_t max = std::min(count, kMaxSearchViews);
    for (std::size_t i = 0; i < max; ++i) searched.push_back(i * count / max);
    return searched;
}

float max_mask(std::span<const SearchView> views, const std::vector<TextureId>& unknowns) {
    const auto has_mask = [](const SearchView& v) { return v.mask.width > 0; };
    if (unknowns.empty() || std::ranges::none_of(views, has_mask)) return 1;
    SearchPlan plan;
    plan.unknowns = unknowns;
    const Scene& scene = *views.front().scene.scene;
    const std::vector<char> unknown = unknown_bsdfs(scene, unknown_slots(scene, plan));
    std::vector<float> max(views.size(), 0);
    parallel_for(views.size(), [&](std::size_t v) {
        const SearchView& view = views[v];
        const std::vector<char> seen = seen_pixels(view.scene, unknown);
        const int width = view.scene.film.crop_width;
        for (std::size_t k = 0; k < seen.size(); ++k) {
            const int y = static_cast<int>(k) / width, x = static_cast<int>(k) % width;
            for (int c = 0; seen[k] && c < 3; ++c)
                max[v] = std::max(max[v], static_cast<float>(mask_at(view.mask, x, y, c)));
        }
    });
    const float all = *std::ranges::max_element(max);
    return all > 0 ? all : 1;
}

SearchPlan make_search_plan(std::span<const SearchView> views,
                            std::span<const SearchUnknown> unknowns, std::uint32_t seed,
                            double effort) {
    const Scene& scene = *views.front().scene.scene;
    std::vector<TextureId> textures;
    for (const SearchUnknown& u : unknowns) textures.push_back(u.texture);
    SearchPlan plan = grouped(scene, std::move(textures));
    plan.seed = seed;
    double work = kTraceWork, candidates = kFewCandidates;
    bool beside_colors = false;
    for (SearchGroup& g : plan.groups) {
        g.candidates = make_candidates(scene, plan, g);
        g.prior_costs = make_prior_costs(scene, plan, g);
        const auto count = static_cast<double>(g.candidates.size());
        candidates = std::max(candidates, count);
        beside_colors |= g.color && count > 1;
        work += count * (g.color ? 3 : 1);  // black and white, and in samples of colours alone
    }
    if (beside_colors) work += kTraceWork / 2;  // half as many samples tell the colours first
    const double seen = std::max(1.0, count_seen(views, plan));
    const auto scale_with = [&](double least_passes) {
        return scale_for(seen, least_passes * std::cbrt(candidates / kFewCandidates), work);
    };
    plan.scale = scale_with(beside_colors ? kPassesBesideColors : kPassesOfPixels);
    if (plan.scale > 1 && !beside_colors) plan.scale = scale_with(kPassesOfSquares);
    const double squares = std::max(1.0, seen / (plan.scale * plan.scale));
    double passes = kMaxWork / (2 * squares * work);
    if (plan.scale == 1) passes = std::min(passes, kMaxPassesOfPixels);
    plan.passes = static_cast<std::uint32_t>(effort * passes);
    const double of_block = beside_colors ? kSquaresBesideColors : kSquaresOfBlock;
    const double blocks =
        std::max(1.0, squares * std::min(1 / of_block, 2 * plan.passes / kSamplesOfBlock));
    for (SearchGroup& g : plan.groups) {
        const SearchUnknown& u = unknowns[g.members.front()];
        const auto& bitmap = std::get<Bitmap>(scene[u.texture]);
        g.regions =
            make_regions(u.charts, bitmap.width, bitmap.height, region_side(bitmap, blocks));
        g.guides = u.guides;  // as of all of its members
        if (g.guides.size() > kMaxGuides) g.guides.resize(kMaxGuides);
        if (!g.guides.empty()) g.guide_means = read_guides(scene, g, bitmap);
    }
    return plan;
}

}  // namespace burnish
