// Options of which only the scene and its pictures tell that they have no effect.
#pragma once

#include "cli/run_result.h"

namespace burnish {

/// Warns of each one. run: with textures, and with the sources of its views.
void warn_without_effect(const Scene& scene, const RunResult& run);

}  // namespace burnish
