#include "captures/colmap_model.h"

#include <fmt/format.h>

#include "burnish/error.h"
#include "image/image.h"

namespace burnish {

int colmap_side(const std::string& place, const std::string& found, double pixels) {
    if (is_side(pixels)) return static_cast<int>(pixels);
    throw InputError(fmt::format("{}: found a side of {} pixels, expected 1 to {}", place, found,
                                 kMaxImageSide));
}

}  // namespace burnish
