// Whether a state is one of a problem and its options.
#pragma once

#include "optimize/setup.h"
#include "optimize/state.h"

namespace burnish {

/// Throws InputError where it is not: other unknowns, sizes, levels, starts, another estimator, or
/// samples that this scene and this camera do not have. What it lets through can be iterated.
void require_state_of(const Setup& setup, const State::Values& state);

}  // namespace burnish
