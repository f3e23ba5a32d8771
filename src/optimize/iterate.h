// The loop's body: image -> loss -> gradient -> step.
#pragma once

#include "core/parallel.h"
#include "optimize/setup.h"
#include "optimize/state.h"

namespace burnish {

/// The state before the first iteration.
State::Values make_state(const Setup& setup);

/// That of a view before its first visit.
ViewState make_view_state(const Setup& setup, std::size_t view);

/// The work memory of a state. Throws ResourceError where PathCache::max_bytes holds less than one
/// pass in each half.
Workspace make_workspace(const Setup& setup, const State::Values& state);

/// Advances the state by one iteration, and the views that it visits by one visit; of several
/// processes each visits its own. The gradient is the mean over these views. Image and derivative
/// use independent random numbers [PR sec. 2.2]. Where it throws, anything but ResourceError or
/// what Ranks::exchange throws in the step, the state is what it was before: an iteration is done
/// as a whole or not at all. stop: where it says so before the step begins, throws Stopped.
Iteration iterate(const Setup& setup, State::Values& state, Workspace& workspace,
                  const StopQuestion& stop = {});

}  // namespace burnish
