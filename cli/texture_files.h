// Images that a command is given: texture values, radiance; names of files and folders.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "burnish/photograph.h"
#include "burnish/solve.h"
#include "image/image.h"
#include "scene/scene.h"

namespace burnish {

/// Texels for a bitmap, from a number as text (fills every channel) or an image file of the
/// bitmap's size, or of that of the scene's file, which may be one texel wide or high. Integer
/// files are sRGB-decoded unless the bitmap is raw; RGB for a one-channel bitmap becomes luminance,
/// gray for RGB is repeated. Throws InputError; `what` says whose value it is.
Image read_texels(const Bitmap& bitmap, const std::string& text, const std::string& what);

/// A linear image of the given size, 1 or 3 channels. Throws InputError that says both sizes, or
/// where a value is not finite.
Image read_radiance(const std::filesystem::path& file, int width, int height,
                    const std::string& what);

/// The name of a parameter or a view as that of a folder, or of a file without extension: of plain
/// letters, and cut where it is too long. Names may become the same.
std::string file_name_of(const std::string& given);

/// Each that an earlier one has gets the first of the endings _2, _3 and so on that none before it
/// has.
std::vector<std::string> unique_names(std::vector<std::string> names);

/// A name of its own for the folder of each view.
std::vector<std::string> folder_names(const std::vector<View>& views);

}  // namespace burnish
