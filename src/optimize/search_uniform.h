// Members of a group that are one texel, as constants are: all regions have the same value of them.
#pragma once

#include "optimize/search_sums.h"

namespace burnish {

/// Of costs [regions, candidates] that are 0 at the cheapest one: those of candidates with the
/// values of such members with which the known regions lose least together, each at its cheapest
/// candidate, begin at 0 in every region; all others become more than neighbours and guides save.
/// Over so many squares losses are without noise, and costs are not.
void fix_uniform(const GroupSearch& s, std::vector<float>& costs);

/// What such a member starts from: the value that most squares have by their regions' labels, or
/// the colour that all squares give; 0.5 where nothing is known.
float uniform_value(const GroupSearch& s, const std::vector<std::uint32_t>& labels,
                    std::size_t member, std::size_t channel);

}  // namespace burnish
