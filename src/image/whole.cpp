#include "image/whole.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "image/image.h"

namespace burnish {

void require_whole(const Image& image, const std::string& what) {
    if (is_whole(image)) return;
    throw InputError(
        fmt::format("{} has {} values for {} x {} pixels of {} channels: expected one for each "
                    "channel of a pixel",
                    what, image.values.size(), image.width, image.height, image.channels));
}

void require_finite(const Image& image, const std::string& what, const std::string& expected) {
    if (is_finite(image)) return;
    std::size_t count = 0, first = 0;
    for (std::size_t i = image.values.size(); i-- > 0;)
        if (!std::isfinite(image.values[i])) ++count, first = i;
    const auto pixel = first / static_cast<std::size_t>(image.channels);
    const auto width = static_cast<std::size_t>(image.width);
    throw InputError(fmt::format(
        "{}: {} of {} values are not finite, the first one ({}) at pixel ({}, {}): {}", what, count,
        image.values.size(), image.values[first], pixel % width, pixel / width, expected));
}

void require_weights(const Image& mask, const std::string& what) {
    require_finite(mask, what);
    if (mask.values.empty()) return;
    const float min = *std::ranges::min_element(mask.values);
    require(min >= 0,
            fmt::format("{} holds {:g}, expected weights that are not negative", what, min));
}

}  // namespace burnish
