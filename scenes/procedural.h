// Scenes that the project makes itself: meshes, textures, lights and the XML around them, from
// formulas and counter-based random numbers. A written scene is an ordinary Mitsuba 3 scene folder.
//
// To add a scene: one file with `procedural::write_NAME` declared in
// scenes/scene_files.h, and a row in procedural.cpp.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenes/procedural_options.h"

namespace burnish {

/// The names that write_procedural_scene knows.
std::vector<std::string> procedural_scene_names();

/// Writes scene.xml, meshes/*.ply, textures/* and LICENSE into the folder, which is made where it
/// is missing; files of an earlier call are replaced. The same name, options and binary give the
/// same bytes. Throws InputError: an unknown name, a texture size out of range; OutputError: a
/// folder or a file that cannot be written.
void write_procedural_scene(const std::string& name, const std::filesystem::path& folder,
                            const ProceduralOptions& options = {});

}  // namespace burnish
