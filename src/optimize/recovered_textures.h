// What a run has found.
#pragma once

#include <vector>

#include "optimize/setup.h"
#include "optimize/state.h"

namespace burnish {

/// What the state says of its unknowns. Texels that no sample visited become what
/// Options::unvisited asks for.
std::vector<RecoveredTexture> recovered_textures(const Setup& setup, const State::Values& state);

}  // namespace burnish
