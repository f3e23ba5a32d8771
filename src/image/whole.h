// Whether an image has the values that its size asks for, and finite ones: those that others made
// may not.
#pragma once

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
void require_whole(const Image& image, const std::string& what);

/// Throws InputError where values of a whole image are infinite or NaN: how many, and the first of
/// them with its pixel. expected: how the message ends.
void require_finite(const Image& image, const std::string& what,
                    const std::string& expected = "expected finite ones");

/// Throws InputError where a whole mask holds what is no weight: infinite or NaN, as require_finite
/// says it, or negative.
void require_weights(const Image& mask, const std::string& what);

/// Throws InputError where a photograph's images are not whole, or not of one size and as many
/// channels as they have.
void require_whole(const Photograph& photograph);

}  // namespace burnish
