// A gradient and most of its noise: two estimates, each of samples of both halves.
#pragma once

#include "core/dirty_blocks.h"
#include "image/image.h"

namespace burnish {

/// dL / d(texture), [height, width, channels]: first + second, each an estimate of one half of it:
/// the derivatives of one half of the samples, weighed by the image of the other. first - second
/// has a mean of zero and less noise than the sum: errors of an image and of its derivative within
/// a half go together, and both halves share a background. second of width 0: all of it is in
/// `first`, and nothing is known of its noise.
struct SplitGradient {
    Image first, second;
    DirtyBlocks dirty = {};  ///< where either half may not be zero; empty: anywhere
};

/// Makes both halves zero and gives them a shape. What is zero by its flags is not written again.
void clear(SplitGradient& gradient, int width, int height, int channels, bool split = true);

/// Adds a gradient of the same shape, split alike.
void add(const SplitGradient& gradient, SplitGradient& to);

/// first + second
Image sum_of(const SplitGradient& gradient);

}  // namespace burnish
