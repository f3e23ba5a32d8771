// What a search for the start chooses for the regions of a group, from the sums of what they lose.
#pragma once

#include "optimize/search_sums.h"

namespace burnish {

/// The colour that the squares of a region and of those around it give it at each candidate; empty
/// without a colour.
GroupColors choose_colors(const GroupSearch& s);

/// Costs [regions, candidates] and how seldom regions have a candidate by an earlier choice: minus
/// the logarithm of its share, as if one region more had all candidates alike.
std::vector<float> with_share_costs(const std::vector<char>& known,
                                    const std::vector<std::uint32_t>& labels,
                                    std::size_t candidates, std::vector<float> costs);

/// What is chosen for a group.
struct GroupChoice {
    GroupSearch search;
    std::vector<std::uint32_t> labels;  ///< the candidate of each region
    std::vector<Image> starts;          ///< the members' textures, [height, width, channels]
};

/// A region whose own squares leave it open has the label of regions whose guides are alike, and of
/// its neighbours. The starts follow from the labels; with guides each texel is as its leaf, moved
/// by what its region differs from what they say.
GroupChoice choose(const GroupSearch& search, const Scene& scene);

/// The same, after an earlier choice from less: regions that it knew keep their label unless the
/// new one is more than a step of the candidates away, since descent finds its way there. Regions
/// whose label stays keep their start, but those that become known.
GroupChoice choose_again(const GroupSearch& search, const GroupChoice& earlier, const Scene& scene);

/// What was tried, for people.
SearchedGroup describe(const GroupChoice& choice);

}  // namespace burnish
