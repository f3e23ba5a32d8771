// The loop's body: image -> loss -> gradient -> step.
#pragma once

#include "optimize/setup.h"
#include "optimize/state.h"
#include "render/render.h"

namespace burnish {

/// The state before the first iteration.
State::Values make_state(const Setup& setup);

/// That of a view before its first visit.
ViewState make_view_state(const Setup& setup, std::size_t view);

/// The work memory of a state. Throws ResourceError where PathCache::max_bytes holds less than one
/// pass in each half.
Workspace make_workspace(const Setup& setup, const State::Values& state);

/// Advances the state by one iteration, and the views that it visits by one visit. The gradient is
/// the mean over these views. Image and derivative use independent random numbers [PR sec. 2.2].
Iteration iterate(const Setup& setup, State::Values& state, Workspace& workspace);

/// Names samples of an evaluation: two halves, independent of each other. salt tells evaluations
/// apart.
struct EvaluationKey {
    std::uint32_t salt = 0, half = 0;
};

/// The image of theta in a view, from so many fresh samples per pixel.
Image evaluation_image(const Setup& setup, std::size_t view, const Theta& theta, EvaluationKey key,
                       std::uint32_t passes, const Progress& progress = {});

/// Of all views. samples_per_pixel: at least 2.
Evaluation evaluate(const Setup& setup, const Theta& theta, std::uint32_t samples_per_pixel,
                    std::uint32_t salt, const Progress& progress = {});

/// What the state says of its unknowns. `texels` that no sample visited become what
/// Options::unvisited asks for.
std::vector<RecoveredTexture> recovered_textures(const Setup& setup, const State::Values& state);

}  // namespace burnish
