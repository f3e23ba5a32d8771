// Views from the files of cameras that other programs write. To add a format: its views_NAME.cpp, a
// line in read_views, the sentences of problem.views in cli/run_table.cpp and of read_views in
// python/captures.cpp.
#pragma once

#include <string>
#include <vector>

#include "captures/capture.h"

namespace burnish {

/// The views of a COLMAP reconstruction (a folder) or a transforms.json. images: the folder of the
/// pictures; may be empty for a transforms.json. Throws InputError.
std::vector<CapturedView> read_views(const std::string& views, const std::string& images);

}  // namespace burnish
