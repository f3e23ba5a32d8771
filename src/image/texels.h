// Images as textures and environments read them.
#pragma once

#include <cstddef>

#include "burnish/image.h"

namespace burnish {

/// An image with a side of one pixel, repeated to two.
Image padded_to_two(Image image);

/// Texels of an environment [height, width, 3] that have a negative luminance become black, since
/// they cannot be sampled: returns how many. Other colours outside of the gamut stay, as in
/// Mitsuba.
std::size_t drop_negative(Image& image);

}  // namespace burnish
