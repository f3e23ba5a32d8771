// The scene of a run that is given none.
#pragma once

#include <filesystem>

#include "cli/output_folder.h"

namespace burnish {

/// Where it lies among unfinished results while its textures are recovered.
inline constexpr const char* kBuiltIn = "built-in";

/// Writes it below what is unfinished, and returns its file. A process that helps gets a temporary
/// folder for it. Throws OutputError.
std::filesystem::path write_demo_scene(OutputFolder& output);

}  // namespace burnish
