// A script that makes Blender materials of the recovered textures, for meshes that are in Blender
// already.
#pragma once

#include <string>

#include "cli/run_result.h"
#include "mitsuba/loaded_scene.h"

namespace burnish {

/// Python for Blender 4 and newer, to be kept beside textures/ and scene/: a Principled BSDF for
/// each material that reads a recovered texture. has_scene: scene/ was written; otherwise textures
/// of the scene are left out.
std::string blender_script(const LoadedScene& loaded, const RunResult& run, bool has_scene);

}  // namespace burnish
