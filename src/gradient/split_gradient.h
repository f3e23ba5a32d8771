// A gradient with its noise: two estimates that know nothing of each other.
#pragma once

#include "core/dirty_blocks.h"
#include "image/image.h"

namespace burnish {

/// dL / d(texture), [height, width, channels]: first + second, each an estimate of one half of it
/// from samples of its own. first - second has the noise of the sum and a mean of zero. second of
/// width 0: all of it is in `first`, and nothing is known of its noise.
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
