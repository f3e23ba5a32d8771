// Members of a group that are one texel, as constants are: all regions have the same value of them.
#pragma once

#include "optimize/search_sums.h"

namespace burnish {

/// Adds to the costs [regions, candidates] of all candidates but those with the values of such
/// members with which the regions lose least together, each at its cheapest candidate: more than
/// any choice saves. Over so many squares losses are without noise, and costs are not.
void fix_uniform(const GroupSearch& s, std::vector<float>& costs);

/// What such a member starts from: the value that most squares have by their regions' labels, or
/// the colour that all squares give; 0.5 where nothing is known.
float uniform_value(const GroupSearch& s, const std::vector<std::uint32_t>& labels,
                    std::size_t member, std::size_t channel);

}  // namespace burnish
