// What other programs take of a result: the scene with the recovered textures, for Mitsuba; a model
// and a script, for Blender and others.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/run_result.h"
#include "mitsuba/loaded_scene.h"

namespace burnish {

/// The names of the files that write_deliverables writes at most, in the folder of the results.
std::vector<std::string> deliverable_names(const LoadedScene& loaded, const RunResult& run);

/// Writes scene/, model.glb and import_into_blender.py into the folder of the results, which has
/// textures/ already, and notes them in `run`. What cannot be written, as when the scene's files
/// have gone, is left out with a warning.
void write_deliverables(const LoadedScene& loaded, const std::filesystem::path& folder,
                        RunResult& run);

}  // namespace burnish
