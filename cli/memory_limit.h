// --max-memory: what the runs will take, and what is left of the limit for a path cache.
#pragma once

#include "cli/run_result.h"
#include "optimize/memory.h"

namespace burnish {

/// Estimates the memory of the runs on these views, whose `reaching` is found here, into
/// run.memory, shortens the windows of path caches to the limit, and describes them in
/// run.kept_text. Throws ResourceError where the limit is too low.
void plan_memory(RunViews views, RunResult& run);

}  // namespace burnish
