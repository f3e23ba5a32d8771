// Image files whose values are no colours.
#pragma once

#include "image/image.h"

namespace burnish {

/// read_image_file, but X, Y, Z and chromaticities of a file do not change its values.
ImageFile read_numbers_file(const std::filesystem::path& file);

}  // namespace burnish
