#include "captures/views.h"

#include <fmt/format.h>

#include <filesystem>

#include "burnish/error.h"
#include "captures/views_colmap.h"
#include "captures/views_transforms.h"
#include "image/files.h"

namespace burnish {

std::vector<CapturedView> read_views(const std::string& views, const std::string& images) {
    const std::filesystem::file_status status = status_of(views);
    if (std::filesystem::is_directory(status)) {
        if (images.empty()) {
            require_reconstruction(views);
            throw InputError("images: expected the folder of the pictures that " + views +
                             " names");
        }
        return read_colmap(views, images);
    }
    if (lower_extension(views) != ".json")
        throw InputError(fmt::format(
            "{}: {}expected the folder of a COLMAP reconstruction, or a transforms.json", views,
            std::filesystem::exists(status) ? "" : "no such file or folder, "));
    return read_transforms(views, images);
}

}  // namespace burnish
