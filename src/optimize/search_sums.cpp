#include "optimize/search_sums.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "optimize/search_samples.h"

namespace burnish {

namespace {

/// The sums of the regions that a tile meets.
struct TileSums {
    std::vector<std::uint32_t> regions;  ///< in ascending order
    GroupSums of;                        ///< parallel to regions
};

/// Pictures of both halves.
using Pictures = std::array<std::vector<float>, 2>;

/// Of one square. white: with white colours instead of black; empty: without colours.
ColorSums square_sums(const float* target, const float* weight, std::size_t square,
                      const Pictures& black, const Pictures& white) {
    ColorSums s;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t i = 3 * square + c;
        const double w = double{weight[c]};
        const double r0 = double{black[0][i]} - double{target[c]};
        const double r1 = double{black[1][i]} - double{target[c]};
        s.rr[c] = w * r0 * r1;
        if (white[0].empty()) continue;
        const double b0 = double{white[0][i]} - double{black[0][i]};
        const double b1 = double{white[1][i]} - double{black[1][i]};
        s.bb[c] = w * b0 * b1;
        s.br[c] = w * 0.5 * (b0 * r1 + b1 * r0);
    }
    return s;
}

/// Without a colour.
double cost_of(const ColorSums& square) {
    return std::log(std::max(0.0, square.rr[0] + square.rr[1] + square.rr[2]) + kNoLoss);
}

GroupSums make_sums(std::size_t regions, const SearchGroup& group) {
    const std::size_t all = regions * group.candidates.size();
    return {std::vector<double>(regions), std::vector<ColorSums>(all),
            std::vector<double>(group.has_color ? 0 : all)};
}

TileSums find_regions(std::span<const RegionShare> shares, const SearchGroup& group) {
    TileSums t;
    for (const RegionShare& s : shares) t.regions.push_back(s.region);
    std::sort(t.regions.begin(), t.regions.end());
    t.regions.erase(std::unique(t.regions.begin(), t.regions.end()), t.regions.end());
    t.of = make_sums(t.regions.size(), group);
    return t;
}

TileSums sum_tile(const SearchFrame& f, const Tile& tile, const std::array<TileSamples, 2>& halves,
                  std::size_t group, std::span<const RegionShare> shares) {
    const SearchGroup& g = f.plan.groups[group];
    const std::size_t candidates = g.candidates.size();
    TileSums t = find_regions(shares, g);
    std::vector<std::size_t> index;
    for (const RegionShare& s : shares) {
        index.push_back(static_cast<std::size_t>(
            std::lower_bound(t.regions.begin(), t.regions.end(), s.region) - t.regions.begin()));
        t.of.squares[index.back()] += double{s.weight};
    }
    for (std::size_t k = 0; k < candidates; ++k) {
        Pictures black, white;
        for (std::size_t h = 0; h < 2; ++h) {
            black[h] = shade_tile(f, halves[h], group, g.candidates[k], 0);
            if (g.has_color) white[h] = shade_tile(f, halves[h], group, g.candidates[k], 1);
        }
        for (std::size_t i = 0; i < shares.size(); ++i) {
            const std::size_t at = 3 * frame_index(f, tile, static_cast<int>(shares[i].square));
            const ColorSums square =
                square_sums(&f.target[at], &f.weight[at], shares[i].square, black, white);
            const std::size_t to = index[i] * candidates + k;
            t.of.sums[to] += square * double{shares[i].weight};
            if (!g.has_color) t.of.costs[to] += double{shares[i].weight} * cost_of(square);
        }
    }
    return t;
}

}  // namespace

ColorSums& operator+=(ColorSums& to, const ColorSums& from) {
    for (std::size_t c = 0; c < 3; ++c)
        to.rr[c] += from.rr[c], to.bb[c] += from.bb[c], to.br[c] += from.br[c];
    return to;
}

ColorSums operator*(const ColorSums& sums, double factor) {
    ColorSums product;
    for (std::size_t c = 0; c < 3; ++c)
        product.rr[c] = sums.rr[c] * factor, product.bb[c] = sums.bb[c] * factor,
        product.br[c] = sums.br[c] * factor;
    return product;
}

GroupSums make_sums(const SearchGroup& group) {
    return make_sums(group.regions.regions.size(), group);
}

void add_view(const SearchFrame& f, std::vector<GroupSums>& sums) {
    const std::vector<SearchTile> tiles = make_search_tiles(f);
    std::vector<std::vector<TileSums>> found(tiles.size());
    parallel_for(tiles.size(), [&](std::size_t i) {
        const std::array<TileSamples, 2> halves{trace_tile(f, tiles[i], 0),
                                                trace_tile(f, tiles[i], 1)};
        const auto shares = find_shares(f, tiles[i].tile, halves);
        for (std::size_t g = 0; g < shares.size(); ++g)
            found[i].push_back(sum_tile(f, tiles[i].tile, halves, g, shares[g]));
    });
    for (const auto& of_tile : found)
        for (std::size_t g = 0; g < of_tile.size(); ++g) {
            const TileSums& t = of_tile[g];
            const std::size_t candidates = f.plan.groups[g].candidates.size();
            for (std::size_t i = 0; i < t.regions.size(); ++i) {
                sums[g].squares[t.regions[i]] += t.of.squares[i];
                for (std::size_t k = 0; k < candidates; ++k) {
                    const std::size_t to = t.regions[i] * candidates + k, from = i * candidates + k;
                    sums[g].sums[to] += t.of.sums[from];
                    if (!sums[g].costs.empty()) sums[g].costs[to] += t.of.costs[from];
                }
            }
        }
}

}  // namespace burnish
