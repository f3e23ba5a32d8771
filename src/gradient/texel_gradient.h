// A gradient by single texels, and what an estimate of it reports.
#pragma once

#include <cstddef>
#include <vector>

#include "gradient/differentiate.h"
#include "gradient/outliers.h"
#include "gradient/split_gradient.h"

namespace burnish {

struct TexelGradient {
    TexelKey key;
    Rgbf g;  ///< dL / d(texel channels); one-channel textures use x
};

struct GradientCounts {
    std::size_t records = 0;     ///< paths that met an unknown
    std::size_t candidates = 0;  ///< their derivatives by single texels
    std::size_t texels = 0;      ///< texels with a gradient
    std::size_t reservoirs = 0;  ///< that the next iteration reads
    std::size_t rejected = 0;    ///< contributions that were not finite
    Outlier largest;             ///< contribution; none of PathCache
};

/// Of estimators without halves.
struct GradientResult {
    std::vector<TexelGradient> gradient;  ///< sorted by key; absent texels have a zero estimate
    GradientCounts counts;
};

/// As images, one per texture of theta, [height, width, channels].
std::vector<Image> dense_gradient(const Theta& theta, const std::vector<TexelGradient>& gradient);

/// The same into `dense`, whose memory is kept from call to call: only texels that are not zero are
/// written.
void make_dense(const Theta& theta, const std::vector<TexelGradient>& gradient,
                std::vector<SplitGradient>& dense);

}  // namespace burnish
