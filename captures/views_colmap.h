// Views from a COLMAP reconstruction: its cameras and images, in text or binary.
#pragma once

#include <string>
#include <vector>

#include "captures/capture.h"

namespace burnish {

/// Throws InputError where a folder holds no reconstruction: what is there in its place.
void require_reconstruction(const std::string& folder);

/// folder: with cameras.bin and images.bin, or else cameras.txt and images.txt. images: the folder
/// that names of images are relative to. Views in the order of these names; pictures are not read.
/// Throws InputError: file and byte or line, what was found and what was expected.
std::vector<CapturedView> read_colmap(const std::string& folder, const std::string& images);

}  // namespace burnish
