// Whether a state is one of a problem and its options.
#pragma once

#include "optimize/setup.h"
#include "optimize/state.h"

namespace burnish {

/// Whether an image is whole and has the width, the height and the channels of another one.
bool has_shape_of(const Image& image, const Image& other);

/// Throws InputError where it is not: other unknowns, sizes, levels, starts, another kind of
/// estimator, or samples that this scene and this camera do not have. What it lets through can be
/// iterated.
void require_state_of(const Setup& setup, const State::Values& state);

}  // namespace burnish
