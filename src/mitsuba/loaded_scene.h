// What reading a scene file takes and gives.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "mitsuba/scene_source.h"
#include "scene/scene.h"

namespace burnish {

/// What is called before a mesh or an image is read, and may throw ResourceError: its file, the
/// bytes that reading it takes at least, and those that the scene keeps of what was read before.
/// For a PLY or a serialized mesh once more, when the file itself has said how large its mesh is,
/// and for each attribute of a mesh that becomes a texture.
using BeforeReading =
    std::function<void(const std::filesystem::path& file, double bytes, double before)>;

struct LoadOptions {
    std::map<std::string, std::string> definitions;  ///< -D name=value; wins over <default>
    int width = 0, height = 0;  ///< replaces the film's size where both are positive
    /// Leaves out what is not supported, with a warning for each, in the place of throwing.
    bool ignore_unsupported = false;
    BeforeReading before_reading = {};
};

struct LoadedScene {
    Scene scene;
    std::vector<std::string> warnings;  ///< one sentence each, with file:line:column; all differ
    /// Defaults that were chosen (integrator, camera), said to the user.
    std::vector<std::string> notes;
    SceneSource source = {};  ///< empty for a scene that no file held
};

}  // namespace burnish
