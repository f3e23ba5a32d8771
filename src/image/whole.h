// Whether an image has the values that its size asks for, and finite ones: those that others made
// may not.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "burnish/photograph.h"
#include "core/require.h"

namespace burnish {

/// Whether there is one value for each channel of a pixel.
inline bool is_whole(const Image& image) {
    return image.width >= 0 && image.height >= 0 && image.channels >= 0 &&
           image.values.size() == image.index(0, image.height);
}

/// Throws InputError where it is not. what: "the mask", for the message.
inline void require_whole(const Image& image, const std::string& what) {
    if (is_whole(image)) return;
    throw InputError(what + " has " + std::to_string(image.values.size()) + " values for " +
                     std::to_string(image.width) + " x " + std::to_string(image.height) +
                     " pixels of " + std::to_string(image.channels) +
                     " channels: expected one for each channel of a pixel");
}

/// How many values are infinite or NaN.
inline std::size_t count_non_finite(const Image& image) {
    return static_cast<std::size_t>(std::count_if(image.values.begin(), image.values.end(),
                                                  [](float v) { return !std::isfinite(v); }));
}

/// Throws InputError where a photograph's images are not whole, or not of one size and as many
/// channels as they have.
void require_whole(const Photograph& photograph);

}  // namespace burnish
