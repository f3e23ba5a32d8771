// Mitsuba's scene language -> Scene. docs/reference/mitsuba.md says what is read and what differs.
#pragma once

#include <filesystem>

#include "mitsuba/loaded_scene.h"

namespace burnish {

/// Reads a scene file, its includes, meshes and textures. Errors are InputError with
/// file:line:column, what was found and what was expected. Files are looked for in <path> folders,
/// the last one first, beside the top-level scene, and beside the included file that names them. A
/// name or a <path> that leaves the folder of the top-level scene (.., absolute, link) is an error.
LoadedScene load_scene(const std::filesystem::path& file, const LoadOptions& options = {});

}  // namespace burnish
