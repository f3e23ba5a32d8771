// Views from a transforms.json, as NeRF, nerfstudio, instant-ngp and Blender's exporters write it.
#pragma once

#include <string>
#include <vector>

#include "captures/capture.h"

namespace burnish {

/// images: the folder that paths of pictures are relative to; empty: that of the file. A picture is
/// read only where the file does not say how large it is. Throws InputError: file and key, what was
/// found and what was expected.
std::vector<CapturedView> read_transforms(const std::string& file, const std::string& images);

}  // namespace burnish
