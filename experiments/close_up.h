// A part of a picture, which shows what the whole is too small for.
#pragma once

#include "image/image.h"

namespace burnish {

/// Whole pixels of a picture, from its corner at the upper left.
struct Square {
    int x = 0, y = 0, side = 1;
};

/// Where two pictures of one size differ most, |a - b| summed over a square: its side is a third of
/// their shorter one, and at least 1.
Square most_different(const Image& a, const Image& b);

/// The pixels of a picture within the square.
Image close_up(const Image& image, const Square& square);

}  // namespace burnish
