#include "optimize/start_search.h"

#include <algorithm>
#include <cmath>

#include "core/stopwatch.h"
#include "optimize/search_exposure.h"
#include "optimize/search_sums.h"

namespace burnish {

namespace {

/// A candidate's loss with its best colour.
struct BestColor {
    double loss = 0;
    std::array<float, 3> color{0.5f, 0.5f, 0.5f};
};

BestColor best_color(const ColorSums& s, bool has_color) {
    BestColor best;
    for (std::size_t c = 0; c < 3; ++c) {
        double color = 0;
        if (has_color) {
            color = s.bb[c] > 0 ? std::clamp(-s.br[c] / s.bb[c], 0.0, 1.0) : 0.5;
            best.color[c] = static_cast<float>(color);
        }
        best.loss += s.rr[c] + 2 * color * s.br[c] + color * color * s.bb[c];
    }
    return best;
}

/// The channels of one unknown that reads all three alike.
ColorSums gray_sums(const ColorSums& s) {
    ColorSums gray = s;
    gray.bb.fill(s.bb[0] + s.bb[1] + s.bb[2]), gray.br.fill(s.br[0] + s.br[1] + s.br[2]);
    return gray;
}

/// What is searched in one group.
struct GroupSearch {
    const SearchPlan& plan;
    const SearchGroup& group;
    const GroupSums& sums;

    std::size_t candidates() const { return group.candidates.size(); }
    std::size_t regions() const { return group.regions.regions.size(); }
    const ColorSums& at(std::size_t region, std::size_t candidate) const {
        return sums.sums[region * candidates() + candidate];
    }
    /// Whether enough squares see the region.
    bool is_known(std::size_t region) const { return sums.squares[region] >= 0.5; }
};

/// The costs of candidates in a region. With a colour: what ratios of its loss count, not
/// differences, since the loss that no candidate takes away differs from region to region.
std::vector<float> make_costs(const GroupSearch& s) {
    std::vector<float> costs(s.regions() * s.candidates(), 0.0f);
    for (std::size_t r = 0; r < s.regions(); ++r) {
        if (!s.is_known(r)) continue;
        const std::size_t first = r * s.candidates();
        const std::span<float> own(&costs[first], s.candidates());
        for (std::size_t k = 0; k < own.size(); ++k) {
            double cost = 0;
            if (s.group.has_color) {
                const double loss = best_color(s.at(r, k), true).loss / s.sums.squares[r];
                cost = std::log(std::max(0.0, loss) + kNoLoss);
            } else {
                cost = s.sums.costs[first + k];
            }
            own[k] = static_cast<float>(cost);
        }
        const float least = *std::min_element(own.begin(), own.end());
        for (float& cost : own) cost -= least;
    }
    return costs;
}

/// How unlike two candidates are, as costs: in steps of a tenth of each member's grid, up to a
/// limit. Less with a colour, whose costs do not grow with the squares that see a region.
std::vector<float> make_distances(const SearchGroup& group) {
    const float step = group.has_color ? 0.5f : 1.5f, most = group.has_color ? 3 : 6;
    std::vector<std::vector<float>> places(group.candidates.size());
    for (std::size_t m = 0; m < group.members.size(); ++m) {
        std::vector<float> grid;
        for (const auto& c : group.candidates) grid.push_back(c[m]);
        std::sort(grid.begin(), grid.end());
        grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
        const float tenths = grid.size() == 1 ? 0 : 10 / static_cast<float>(grid.size());
        for (std::size_t k = 0; k < places.size(); ++k) {
            const auto at = std::lower_bound(grid.begin(), grid.end(), group.candidates[k][m]);
            places[k].push_back(tenths * static_cast<float>(at - grid.begin()));
        }
    }
    std::vector<float> distances;
    for (const auto& a : places)
        for (const auto& b : places) {
            float sum = 0;
            for (std::size_t m = 0; m < a.size(); ++m) sum += std::abs(a[m] - b[m]);
            distances.push_back(step * std::min(sum, most));
        }
    return distances;
}

/// The colour of a region; where its own squares say little, that of those around it.
std::array<float, 3> region_color(const GroupSearch& s, std::uint32_t region,
                                  const std::vector<std::uint32_t>& labels, bool gray) {
    constexpr double kShare = 0.1;
    ColorSums sums = s.at(region, labels[region]);
    for (const std::uint32_t n : neighbours(s.group.regions, region))
        if (s.is_known(n)) sums += s.at(n, labels[n]) * kShare;
    return best_color(gray ? gray_sums(sums) : sums, true).color;
}

/// A channel of a member in each region.
std::vector<float> region_values(const GroupSearch& s, const std::vector<std::uint32_t>& labels,
                                 std::size_t member, std::size_t channel, bool gray) {
    std::vector<char> known(s.regions());
    std::vector<float> values(s.regions());
    for (std::uint32_t r = 0; r < s.regions(); ++r) {
        known[r] = s.is_known(r);
        if (!known[r]) continue;
        values[r] = s.plan.colors[s.group.members[member]]
                        ? region_color(s, r, labels, gray)[channel]
                        : s.group.candidates[labels[r]][member];
    }
    fill_regions(s.group.regions, std::move(known), 0.5f, values);
    return values;
}

/// The texture coordinate of a texel's centre.
Vec2f uv_of(const Bitmap& bitmap, int x, int y) {
    const auto& m = bitmap.to_uv.m;
    const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(bitmap.width) - m[2];
    const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(bitmap.height) - m[5];
    const float det = m[0] * m[4] - m[1] * m[3];
    return {(m[4] * u - m[1] * v) / det, (m[0] * v - m[3] * u) / det};
}

/// The region that lies where a texel of a member is.
std::uint32_t region_of(const GroupSearch& s, const Bitmap& first, const Bitmap& bitmap, int x,
                        int y) {
    if (&first == &bitmap)
        return s.group.regions.of_texel[static_cast<std::size_t>(y * first.width + x)];
    const TexelFootprint foot = footprint(first, uv_of(bitmap, x, y));
    return s.group.regions.of_texel[foot.texel[0]];
}

Image make_start(const GroupSearch& s, const std::vector<std::uint32_t>& labels, const Scene& scene,
                 std::size_t member) {
    const auto bitmap_of_member = [&](std::size_t m) -> const Bitmap& {
        return std::get<Bitmap>(scene[s.plan.unknowns[s.group.members[m]]]);
    };
    const Bitmap &first = bitmap_of_member(0), &bitmap = bitmap_of_member(member);
    Image start = make_image(bitmap.width, bitmap.height, bitmap.channels, 0.5f);
    for (int c = 0; c < bitmap.channels; ++c) {
        const auto values =
            region_values(s, labels, member, static_cast<std::size_t>(c), bitmap.channels == 1);
        for (int y = 0; y < bitmap.height; ++y)
            for (int x = 0; x < bitmap.width; ++x)
                if (const std::uint32_t r = region_of(s, first, bitmap, x, y);
                    r != TextureRegions::kNone)
                    start.at(x, y, c) = values[r];
    }
    return start;
}

/// What was tried, for people.
SearchedGroup describe(const GroupSearch& s, const std::vector<std::uint32_t>& labels) {
    SearchedGroup group{s.group.members, {}};
    double squares = 0;
    for (const double q : s.sums.squares) squares += q;
    for (std::size_t k = 0; k < s.candidates(); ++k) {
        SearchedValues tried{s.group.candidates[k], 0, 0};
        for (std::size_t r = 0; r < s.regions(); ++r) {
            tried.loss += best_color(s.at(r, k), s.group.has_color).loss;
            tried.regions += s.is_known(r) && labels[r] == k;
        }
        tried.loss /= std::max(1.0, 3 * squares);
        group.tried.push_back(std::move(tried));
    }
    return group;
}

/// A twentieth of a run of one minute is what a search takes at most; of a longer one, too.
double effort_of(const Options& options) {
    constexpr double kShortRun = 60, kMostEffort = 4;
    return std::isfinite(options.stop.seconds)
               ? std::clamp(options.stop.seconds / kShortRun, 1.0, kMostEffort)
               : 1;
}

/// At most so many views, spread evenly.
std::vector<SearchView> spread(std::span<const SearchView> views) {
    constexpr std::size_t kMaxViews = 16;
    std::vector<SearchView> some;
    const std::size_t count = std::min(views.size(), kMaxViews);
    for (std::size_t i = 0; i < count; ++i) some.push_back(views[i * views.size() / count]);
    return some;
}

}  // namespace

FoundStarts search_starts(std::span<const SearchView> all_views,
                          std::span<const SearchUnknown> unknowns, std::uint32_t seed,
                          double effort, const std::function<void(double)>& progress) {
    const std::vector<SearchView> some = spread(all_views);
    const Scene& scene = *some.front().scene.scene;
    const SearchPlan plan = make_search_plan(some, unknowns, seed, effort);
    const std::vector<SearchView> views = with_exposures(plan, some);
    std::vector<GroupSums> sums;
    for (const SearchGroup& g : plan.groups) sums.push_back(make_sums(g));
    for (std::size_t v = 0; v < views.size(); ++v) {
        add_view(make_search_frame(plan, views[v], static_cast<std::uint32_t>(v)), sums);
        if (progress) progress((static_cast<double>(v) + 1) / static_cast<double>(views.size()));
    }
    FoundStarts found{std::vector<Image>(unknowns.size()), {}};
    for (std::size_t g = 0; g < plan.groups.size(); ++g) {
        const GroupSearch s{plan, plan.groups[g], sums[g]};
        std::vector<char> known;
        for (std::size_t r = 0; r < s.regions(); ++r) known.push_back(s.is_known(r));
        const auto labels =
            label_regions(s.group.regions, known, make_costs(s), make_distances(s.group));
        for (std::size_t m = 0; m < s.group.members.size(); ++m)
            found.textures[s.group.members[m]] = make_start(s, labels, scene, m);
        found.groups.push_back(describe(s, labels));
    }
    return found;
}

SearchReport find_starts(Setup& setup, const std::function<void(double)>& progress) {
    const Stopwatch watch;
    std::vector<SearchUnknown> unknowns;
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < setup.unknowns.size(); ++i) {
        const UnknownTexture& u = setup.unknowns[i];
        if (u.start_kind != StartKind::kSearched) continue;
        unknowns.push_back({u.texture, texture_charts(*setup.scene->scene, u.texture)});
        indices.push_back(i);
    }
    if (unknowns.empty()) return {};
    std::vector<SearchView> views;
    for (const std::size_t i : setup.fitted) {
        const View& v = setup.problem.views[i];
        views.push_back({scene_of(setup, i), v.image, v.mask, v.exposure});
    }
    FoundStarts found =
        search_starts(views, unknowns, setup.options.seed, effort_of(setup.options), progress);
    for (std::size_t k = 0; k < indices.size(); ++k)
        setup.unknowns[indices[k]].start = std::move(found.textures[k]);
    for (SearchedGroup& g : found.groups)
        for (std::size_t& u : g.unknowns) u = indices[u];
    return {watch.total(), std::move(found.groups)};
}

}  // namespace burnish
