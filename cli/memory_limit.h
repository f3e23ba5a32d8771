// --max-memory: what the runs will take, and what is left of the limit for a path cache.
#pragma once

#include <span>

#include "burnish/renderer.h"
#include "cli/run_result.h"
#include "paths/traced_scene.h"

namespace burnish {

/// Estimates the memory of the runs into run.memory, and shortens the windows of path caches to the
/// limit. Throws ResourceError where the limit is too low.
/// views: those that are fitted.
void plan_memory(std::span<const TracedScene> views, RunResult& run);

/// "path cache: 12 345 pixels see an unknown; two halves of up to 32 passes"; empty of other
/// estimators.
std::string cache_text(std::span<const TracedScene> views, const RunResult& run);

}  // namespace burnish
