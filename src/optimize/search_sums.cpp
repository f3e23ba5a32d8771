#include "optimize/search_sums.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "optimize/search_samples.h"
#include "render/telling.h"

namespace burnish {

namespace {

/// The sums of the regions that a tile meets.
struct TileSums {
    std::vector<std::uint32_t> regions;  ///< in ascending order
    GroupSums of;                        ///< parallel to regions
};

/// Pictures of both halves.
using Pictures = std::array<std::vector<float>, 2>;

/// A square at a candidate.
struct SquareInput {
    const float *target, *weight;   ///< [3]
    std::size_t square = 0;         ///< of the tile
    const Pictures &black, &white;  ///< the group's colours; the same without one

    double a(std::size_t half, std::size_t c) const { return double{black[half][3 * square + c]}; }
    double b(std::size_t half, std::size_t c) const {
        return double{white[half][3 * square + c]} - a(half, c);
    }
};

/// A square whose own ratio is no colour by far counts as one that just is none.
ColorSums color_sums(const SquareInput& s) {
    constexpr double kMin = -1, kMax = 2;
    ColorSums sums;
    for (std::size_t c = 0; c < 3; ++c) {
        const double w = std::sqrt(double{s.weight[c]}), slope = s.b(0, c) + s.b(1, c);
        if (!(slope > 0)) continue;
        const double target = 2 * double{s.target[c]} - s.a(0, c) - s.a(1, c);
        sums.slope[c] = w * slope;
        sums.target[c] = w * std::clamp(target, kMin * slope, kMax * slope);
    }
    return sums;
}

double loss_of(const SquareInput& s, const std::array<float, 3>& color) {
    double loss = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const double target = double{s.target[c]}, by = double{color[c]};
        const double r0 = s.a(0, c) + by * s.b(0, c) - target;
        const double r1 = s.a(1, c) + by * s.b(1, c) - target;
        loss += double{s.weight[c]} * r0 * r1;
    }
    return loss;
}

double cost_of(double loss) { return std::log(std::max(0.0, loss) + kNoLoss); }

GroupSums make_sums(std::size_t regions, const SearchGroup& group) {
    const std::size_t all = regions * group.candidates.size();
    return {std::vector<double>(regions), std::vector<double>(all), std::vector<double>(all),
            std::vector<ColorSums>(group.color ? all : 0)};
}

TileSums find_regions(std::span<const RegionShare> shares, const SearchGroup& group) {
    TileSums t;
    for (const RegionShare& s : shares) t.regions.push_back(s.region);
    std::sort(t.regions.begin(), t.regions.end());
    t.regions.erase(std::unique(t.regions.begin(), t.regions.end()), t.regions.end());
    t.of = make_sums(t.regions.size(), group);
    return t;
}

/// colors: of the group; nothing: only what the squares say of them is added up.
TileSums sum_tile(const TracedTile& tile, std::size_t group, const GroupColors* colors) {
    const SearchFrame& f = tile.frame;
    const SearchGroup& g = f.plan.groups[group];
    const std::vector<RegionShare>& shares = tile.shares[group];
    const std::size_t candidates = g.candidates.size();
    TileSums t = find_regions(shares, g);
    std::vector<std::size_t> index;
    for (const RegionShare& s : shares) {
        index.push_back(static_cast<std::size_t>(
            std::lower_bound(t.regions.begin(), t.regions.end(), s.region) - t.regions.begin()));
        if (colors) t.of.squares[index.back()] += double{s.weight};
    }
    for (std::size_t k = 0; k < candidates; ++k) {
        const GroupPictures pictures = shade_group(tile, group, k);
        const Pictures& black = pictures.black;
        const Pictures& white = g.color ? pictures.white : black;
        for (std::size_t i = 0; i < shares.size(); ++i) {
            const auto own = static_cast<int>(shares[i].square);
            const std::size_t at = 3 * frame_index(f, tile.tile, own);
            const SquareInput square{&f.target[at], &f.weight[at], shares[i].square, black, white};
            const std::size_t to = index[i] * candidates + k;
            const double share = double{shares[i].weight};
            if (g.color) t.of.colors[to] += color_sums(square) * share;
            if (!colors) continue;
            const double loss =
                loss_of(square, g.color ? (*colors)[shares[i].region * candidates + k]
                                        : GroupColors::value_type{});
            t.of.losses[to] += share * loss;
            t.of.costs[to] += share * cost_of(loss);
        }
    }
    return t;
}

void add(const TileSums& t, std::size_t candidates, GroupSums& sums) {
    for (std::size_t i = 0; i < t.regions.size(); ++i) {
        sums.squares[t.regions[i]] += t.of.squares[i];
        for (std::size_t k = 0; k < candidates; ++k) {
            const std::size_t to = t.regions[i] * candidates + k, from = i * candidates + k;
            sums.losses[to] += t.of.losses[from];
            sums.costs[to] += t.of.costs[from];
            if (!sums.colors.empty()) sums.colors[to] += t.of.colors[from];
        }
    }
}

/// Whether there is something to sum up: colours alone without any, costs with those of the group.
bool is_summed(const SearchGroup& group, const GroupColors* colors) {
    return colors ? group.color.has_value() == !colors->empty() : group.color.has_value();
}

/// For each group. colors: of the groups; empty: what the tile says of them alone.
std::vector<TileSums> sum_groups(const ViewTile& t, std::span<const GroupColors> colors) {
    const std::vector<SearchGroup>& groups = t.frame->plan.groups;
    const TracedTile tile = trace_tile(*t.frame, t.tile);
    std::vector<TileSums> sums(groups.size());
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const GroupColors* own = colors.empty() ? nullptr : &colors[g];
        if (is_summed(groups[g], own)) sums[g] = sum_tile(tile, g, own);
    }
    return sums;
}

/// The tiles of all views side by side: a view may have few. Added in their order.
void add_tiles(std::span<const SearchFrame> frames, std::span<const GroupColors> colors,
               std::vector<GroupSums>& sums, const Progress& progress) {
    constexpr std::size_t kAtOnce = 256;  // tiles: bounds what their sums take
    const std::vector<ViewTile> tiles = make_view_tiles(frames);
    Telling telling(progress, static_cast<double>(tiles.size()));
    for (std::size_t begin = 0; begin < tiles.size(); begin += kAtOnce) {
        const auto some = std::span(tiles).subspan(begin, std::min(kAtOnce, tiles.size() - begin));
        std::vector<std::vector<TileSums>> found(some.size());
        parallel_for(some.size(), [&](std::size_t i) {
            found[i] = sum_groups(some[i], colors);
            telling.add(1);
        });
        for (std::size_t i = 0; i < some.size(); ++i)
            for (std::size_t g = 0; g < found[i].size(); ++g)
                add(found[i][g], some[i].frame->plan.groups[g].candidates.size(), sums[g]);
    }
    telling.tell();
}

}  // namespace

ColorSums& operator+=(ColorSums& to, const ColorSums& from) {
    for (std::size_t c = 0; c < 3; ++c)
        to.target[c] += from.target[c], to.slope[c] += from.slope[c];
    return to;
}

ColorSums operator*(const ColorSums& sums, double factor) {
    ColorSums product;
    for (std::size_t c = 0; c < 3; ++c)
        product.target[c] = sums.target[c] * factor, product.slope[c] = sums.slope[c] * factor;
    return product;
}

std::array<float, 3> color_of(const ColorSums& sums, bool gray) {
    ColorSums s = sums;
    if (gray) {
        s.target.fill(sums.target[0] + sums.target[1] + sums.target[2]);
        s.slope.fill(sums.slope[0] + sums.slope[1] + sums.slope[2]);
    }
    std::array<float, 3> color{0.5f, 0.5f, 0.5f};
    for (std::size_t c = 0; c < 3; ++c)
        if (const double own = s.target[c] / s.slope[c]; s.slope[c] > 0 && std::isfinite(own))
            color[c] = static_cast<float>(std::clamp(own, 0.0, 1.0));
    return color;
}

GroupSums make_sums(const SearchGroup& group) {
    return make_sums(group.regions.regions.size(), group);
}

void add_colors(std::span<const SearchFrame> frames, std::vector<GroupSums>& sums,
                const Progress& progress) {
    add_tiles(frames, {}, sums, progress);
}

void add_views(std::span<const SearchFrame> frames, std::span<const GroupColors> colors,
               std::vector<GroupSums>& sums, const Progress& progress) {
    add_tiles(frames, colors, sums, progress);
}

}  // namespace burnish
