// --max-memory: what the runs will take, and what is left of the limit for a path cache.
#pragma once

#include "cli/run_result.h"
#include "mitsuba/loaded_scene.h"
#include "optimize/memory.h"

namespace burnish {

/// While a scene is loaded: throws ResourceError before a file is read that --max-memory is too low
/// for. Empty where it is not given.
BeforeReading limit_of_files(const RunSettings& settings);
/// The same before what rays need is built of the scene.
void require_scene_memory(const Scene& scene, const RunSettings& settings);

/// How many pictures of the run's views may be read at once beside the scene and a state that the
/// run goes on from; what all but the scene take goes into run.memory. Throws ResourceError where
/// --max-memory is too low for one of them.
std::size_t plan_pictures(const Scene& scene, RunResult& run);

/// Estimates the memory of the runs on these views, whose `reaching` is found here, into
/// run.memory, shortens the windows of path caches to the limit, and describes them in
/// run.kept_text; what plan_pictures found stays. Throws ResourceError where the limit is too low.
void plan_memory(RunViews views, RunResult& run);

}  // namespace burnish
