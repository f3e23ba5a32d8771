// A gradient with its noise: two estimates that know nothing of each other.
#pragma once

#include <vector>

#include "burnish/image/image.h"
#include "burnish/inverse/segments.h"

namespace burnish {

/// dL / d(texture), [height, width, channels]: first + second, each an estimate of one half of it
/// from samples of its own. first - second has the noise of the sum and a mean of zero. second of
/// width 0: all of it is in `first`, and nothing is known of its noise.
struct HalvedGradient {
    Image first, second;
    SegmentFlags reached = {};  ///< where either half may not be zero; empty: anywhere
};

/// Makes both halves zero and gives them a shape. What is zero by its flags is not written again.
void clear(HalvedGradient& gradient, int width, int height, int channels, bool halved = true);

/// first + second
Image sum_of(const HalvedGradient& gradient);

/// Gradients that are not in halves.
std::vector<HalvedGradient> unhalved(std::vector<Image> gradients);

}  // namespace burnish
