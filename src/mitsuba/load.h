// Mitsuba's scene language -> Scene. docs/mitsuba.md says what is read and what differs.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace burnish {

struct LoadOptions {
    std::map<std::string, std::string> definitions;  ///< -D name=value; wins over <default>
    int width = 0, height = 0;  ///< replaces the film's size where both are positive
};

struct LoadedScene {
    Scene scene;
    std::vector<std::string> warnings;  ///< one sentence each, with file:line:column
    std::vector<std::string>
        notes;  ///< defaults that were chosen (integrator, camera), said to the user
};

/// Reads a scene file, its includes, meshes and textures. Errors are InputError with
/// file:line:column, what was found and what was expected. Files are looked for beside the file
/// that names them and in <path> folders; a name that leaves the folder of the top-level scene and
/// of the <path> folders (.., absolute, link) is an error.
LoadedScene load_scene(const std::filesystem::path& file, const LoadOptions& options = {});

}  // namespace burnish
