// What a search for the start takes from known textures that the same materials read: which values
// their like have elsewhere, and details finer than a region. A rusty spot is rough wherever rust
// is seen to be rough.
#pragma once

#include "optimize/search_view.h"

namespace burnish {

/// The most that a group has.
inline constexpr std::size_t kMaxGuides = 16;

/// The known bitmaps that BSDFs read together with `unknown`, or with what is recovered beside it,
/// directly or through others, but for those of one value everywhere. None where one of these has
/// none, or is no roughness: what a surface is like elsewhere says little of other numbers, and
/// colours have a search of their own.
/// recovered: with `unknown`, those with a given start included.
std::vector<TextureId> guides_of(const Scene& scene, TextureId unknown,
                                 std::span<const TextureId> recovered);

/// The means of a group's guides over each of its regions.
Rows read_guides(const Scene& scene, const SearchGroup& group, const Bitmap& bitmap);

/// Regions whose guides are alike, from the candidates that regions have. known: non-zero where a
/// region has one.
GuideTree grow_tree(const SearchGroup& group, const std::vector<char>& known,
                    const std::vector<std::uint32_t>& labels);

/// The leaf of each region.
std::vector<std::uint32_t> leaves_of_regions(const SearchGroup& group, const GuideTree& tree);

/// Adds to costs [regions, candidates] how seldom regions of the same leaf have a candidate: minus
/// the logarithm of its share, found together with the regions' own by expectation-maximisation.
/// Half of the logarithm of its share in all regions is taken off: costs are surer of themselves
/// than they should be, and most regions would have what many have.
void add_guide_costs(const SearchGroup& group, const std::vector<std::uint32_t>& leaves,
                     const std::vector<char>& known, std::vector<float>& costs);

/// Where the guides of a group are alike, of the first member's texels and of regions.
struct GuideLeaves {
    std::vector<std::uint8_t> of_texel;    ///< [height, width]
    std::vector<std::uint32_t> of_region;  ///< by the means of its guides
    Rows shares;                           ///< of the leaves among the texels of each region
};
/// bitmap: of the first member.
GuideLeaves find_leaves(const SearchGroup& group, const GuideTree& tree, const Scene& scene,
                        const Bitmap& bitmap);

/// The values of a channel of a member where its guides are alike.
struct GuideFit {
    std::vector<float> values;         ///< of each leaf
    std::vector<float> region_values;  ///< of each region the mean over its texels' leaves
};

/// values: of the regions. The leaves' values are those whose means over regions come nearest.
GuideFit fit_guide(const GuideLeaves& leaves, const std::vector<char>& known,
                   const std::vector<float>& values);

}  // namespace burnish
