// The exposures that a search for the start takes pictures to have, where they are to be fitted.
//
// Pictures are affine in a colour c: e (P + c B). For every candidate the exposures of the views
// and one colour for all of them follow in turns, each in closed form; the candidate that leaves
// the least loss decides. Pixels that see no unknown count, too: they say most about an exposure.
#pragma once

#include "optimize/search_view.h"

namespace burnish {

/// The views with a number for each exposure. The same for any number of threads.
std::vector<SearchView> with_exposures(const SearchPlan& plan, std::span<const SearchView> views);

}  // namespace burnish
