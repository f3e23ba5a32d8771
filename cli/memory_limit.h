// --max-memory: what the runs will take, and what is left of the limit for a path cache.
#pragma once

#include <span>

#include "burnish/renderer.h"
#include "cli/run_result.h"
#include "paths/traced_scene.h"

namespace burnish {

/// Estimates the memory of the runs into run.memory, shortens the windows of path caches to the
/// limit, and describes them in run.kept_text. Throws ResourceError where the limit is too low.
void plan_memory(std::span<const TracedScene> fitted, std::span<const TracedScene> held_out,
                 RunResult& run);

}  // namespace burnish
