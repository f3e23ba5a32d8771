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

/// The candidate of each region: where its own squares leave it open, as that of regions whose
/// guides are alike, and as its neighbours'.
std::vector<std::uint32_t> choose_labels(const GroupSearch& s);

/// The same, after an earlier choice from less: regions that it knew keep that one unless the new
/// one is more than a step of the candidates away, since descent finds its way there.
std::vector<std::uint32_t> choose_again(const GroupSearch& s, const GroupSearch& earlier,
                                        const std::vector<std::uint32_t>& before);

/// The textures of the group's members, [height, width, channels] each, that follow from labels;
/// with guides each texel as its leaf, moved by what its region differs from what they say.
std::vector<Image> make_starts(const GroupSearch& s, const std::vector<std::uint32_t>& labels,
                               const Scene& scene);

/// The same after a search that follows `earlier`: regions whose label is still that of `before`
/// stay as they are in `starts`, which were made of these, but those that become known.
std::vector<Image> make_starts_again(const GroupSearch& s, const GroupSearch& earlier,
                                     const std::vector<std::uint32_t>& before,
                                     const std::vector<std::uint32_t>& labels, const Scene& scene,
                                     const std::vector<Image>& starts);

/// What was tried, for people.
SearchedGroup describe(const GroupSearch& s, const std::vector<std::uint32_t>& labels);

}  // namespace burnish
