// Blocks of texels that take one value together: squares of a texture, cut apart where charts
// meet, so that no region reaches over a seam. Where many charts meet in a block, each is too small
// to tell anything by itself, and the block is one region: there are at most kMaxCharts for each.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "texture/charts.h"

namespace burnish {

/// The part of a block that one chart covers.
struct Region {
    static constexpr std::uint32_t kJoined = 0;

    int x = 0, y = 0;         ///< of the block
    std::uint32_t chart = 0;  ///< kJoined: all of a block that is not cut

    friend bool operator==(const Region&, const Region&) = default;
};

struct TextureRegions {
    static constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);
    static constexpr std::size_t kMaxCharts = 8;  ///< of a block that is cut

    int width = 0, height = 0;            ///< texels
    int side = 1;                         ///< texels on a side of a block
    std::vector<Region> regions;          ///< block by block, row by row
    std::vector<std::uint32_t> of_texel;  ///< [height, width]; kNone where no surface reads it
    std::vector<std::uint32_t> first;     ///< of each block its first region; then the end
};

/// charts: of the texels, [height, width].
TextureRegions make_regions(const ChartMap& charts, int width, int height, int side);

/// The other regions of the same chart in the 3 x 3 blocks around a region; of a joined one those
/// that are joined, too.
std::vector<std::uint32_t> neighbours(const TextureRegions& regions, std::uint32_t region);

/// Gives regions that are not known the mean of those around them in their chart, ring by ring;
/// those of charts of which nothing is known the mean of all known ones, or `otherwise` where
/// nothing is known at all. known: non-zero where a value is, parallel to values and regions.
void fill_regions(const TextureRegions& regions, std::vector<char> known, float otherwise,
                  std::vector<float>& values);

/// The labels of regions with a small sum of their own costs and of `distance` over all pairs of
/// neighbours: a Markov random field, by loopy belief propagation (min-sum, a fixed number of
/// rounds). costs: [regions, labels]. distance: [labels, labels], symmetric, 0 on its diagonal; a
/// fourteenth of it between regions of other kinds. kinds: parallel to regions; empty: one.
/// present: non-zero where a region takes part, parallel to regions; the others get label 0. The
/// same for any number of threads.
std::vector<std::uint32_t> label_regions(const TextureRegions& regions,
                                         const std::vector<char>& present,
                                         std::span<const float> costs,
                                         std::span<const float> distance,
                                         std::span<const std::uint32_t> kinds = {});

}  // namespace burnish
