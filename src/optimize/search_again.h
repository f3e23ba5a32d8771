// Searches during a run. Each traces fresh samples in all views, as the search for the start did,
// and adds what they say to what all searches before have said. Where a region's choice becomes
// clearly another one, it starts anew from there; elsewhere every texel keeps what descent has made
// of it.
#pragma once

#include "core/parallel.h"
#include "optimize/search_sums.h"
#include "optimize/setup.h"
#include "optimize/state.h"

namespace burnish {

/// The iterations before the first of the searches that Options::search_again asks for.
std::uint32_t first_search(const Options& options);

/// What a search for the start leaves for those that follow; to be called once, before the first
/// iteration. sums: of all of its groups.
void keep_search(const Options& options, std::vector<GroupSums> sums, double effort,
                 State::Values& state);

/// Searches again where Options::search_again says so before the state's next iteration, once: the
/// state remembers it. Of several processes each searches its own views. The same for any number of
/// threads and processes. One that is asked to stop throws Stopped and leaves the state as it was;
/// after one that fails the next ends as it would have.
void search_again(const Setup& setup, State::Values& state, const StopQuestion& stop = {});

/// Whether what the state keeps of searches is of this problem.
bool are_search_costs(const Setup& setup, const State::Values& state);

}  // namespace burnish
