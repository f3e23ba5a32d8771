// What is not finite, or too large to be summed and squared: it is left out and counted, so that it
// never reaches a texture.
#pragma once

#include <string>

#include "gradient/split_gradient.h"
#include "optimize/setup.h"

namespace burnish {

/// Makes values that are not finite 0; returns their number.
std::size_t leave_out_non_finite(Image& image);

/// Whether a gradient's squares, and its sums over a texture, are finite.
bool is_usable(const SplitGradient& gradient);
/// Makes the values 0 because of which it is not; returns how many of them are among the floats
/// [begin, end) of a half.
std::size_t leave_out_unusable(SplitGradient& gradient, std::size_t begin = 0,
                               std::size_t end = ~std::size_t{0});

/// What is wrong with an iteration of which more than one sample in 1000 was left out; empty:
/// nothing.
std::string non_finite_text(const Setup& setup, const Iteration& iteration);

}  // namespace burnish
