// The loop's body: image -> loss -> gradient -> step.
#pragma once

#include "optimize/setup.h"
#include "optimize/state.h"
#include "render/render.h"

namespace burnish {

/// The state before the first iteration.
State::Values make_state(const Setup& setup);

/// Advances the state by one iteration. The image and the derivative use independent random numbers
/// [PR sec. 2.2].
Iteration iterate(const Setup& setup, State::Values& state, Workspace& workspace);

/// The image of theta from fresh samples: passes [first, first + passes) of an evaluation. salt
/// tells evaluations apart.
Image evaluation_image(const Setup& setup, const Theta& theta, std::uint32_t salt,
                       std::uint32_t first, std::uint32_t passes, const Progress& progress = {});

/// samples_per_pixel: at least 2.
Evaluation evaluate(const Setup& setup, const Theta& theta, std::uint32_t samples_per_pixel,
                    std::uint32_t salt, const Progress& progress = {});

/// What the state says of its unknowns. `texels` that no sample visited become what
/// Options::unvisited asks for.
std::vector<RecoveredTexture> recovered_textures(const Setup& setup, const State::Values& state);

}  // namespace burnish
