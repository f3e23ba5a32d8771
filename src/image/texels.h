// Images as textures and environments read them.
#pragma once

#include <cstddef>

#include "burnish/image.h"

namespace burnish {

/// An image with sides of at least so many pixels: its last column and row are repeated.
Image padded_to(Image image, int width, int height);

/// Columns and rows that a bitmap has at least, as in Mitsuba.
inline constexpr int kBitmapSide = 2;

/// Rows that an environment has at least: Mitsuba repeats the last of two.
inline constexpr int kEnvironmentRows = 3;

/// Texels of an environment [height, width, 3] that have a negative luminance become black, since
/// they cannot be sampled: returns how many. Other colours outside of the gamut stay, as in
/// Mitsuba.
std::size_t drop_negative(Image& image);

}  // namespace burnish
