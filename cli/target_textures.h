// The textures that a run is to recover, as the settings name them.
#pragma once

#include <vector>

#include "cli/run_result.h"

namespace burnish {

/// Their initial values, learning rates, and truths where the target is rendered from them. Takes
/// the colours from textures whose numbers alone are read: there is nothing to recover them from.
/// Throws InputError.
/// rendered: pictures are rendered from the scene's textures, which are the truth then.
std::vector<TargetTexture> make_target_textures(const Settings& settings, bool rendered,
                                                Scene& scene);

/// Says which truths hold values that no unknown takes, in RunResult::warnings too.
void warn_of_truths(RunResult& run);

}  // namespace burnish
