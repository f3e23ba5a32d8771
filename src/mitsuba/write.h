// A scene that was read, written again with other values of parameters: a folder that works by
// itself, in the same scene language. Parameters keep their names.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "core/vec.h"
#include "mitsuba/scene_source.h"

namespace burnish {

/// A bitmap in the place of a parameter's texture or constant. Where there was a texture, its
/// filter, wrap mode, uv transform and `raw` stay.
struct BitmapFile {
    std::string file;  ///< relative to the new scene; of linear floats, whatever `raw` says
    bool raw = true;   ///< of a texture in the place of a constant: it holds no colours
};

struct NewValue {
    ParameterSource at;
    std::variant<BitmapFile, float, Rgbf> value;
};

/// Writes scene.xml into the folder, with copies of all files that it still names, where they lie
/// in the scene's own folder. Files of `values` are the caller's to write. Throws InputError: a
/// file has gone, or leads out of the scene's folder by a link that it has become since.
void write_scene(const SceneSource& source, const std::vector<NewValue>& values,
                 const std::filesystem::path& folder);

/// The name of the copy of a parameter's bitmap; empty where the scene gives a constant. Throws
/// InputError where the file leads out of the scene's folder.
std::string file_of(const SceneSource& source, const ParameterSource& parameter);

/// The names of the files that write_scene copies at most, relative. Throws as file_of.
std::vector<std::string> files_of(const SceneSource& source);

}  // namespace burnish
