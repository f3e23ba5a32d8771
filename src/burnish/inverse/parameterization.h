// What the optimiser moves, and the texture that follows from it. The gradient of the loss by the
// texture becomes the gradient by the parameters through the transposed map, so any of them is an
// unbiased descent on its own parameters.
#pragma once

#include <vector>

#include "burnish/image/image.h"
#include "burnish/inverse/optimizer.h"

namespace burnish {

enum class Parameterization {
    kTexels,   ///< every texel on its own: the paper's
    kPyramid,  ///< the texture is a sum of levels of halved resolution, upsampled: neighbouring
               ///< texels share evidence
};

/// A texture as the optimiser sees it: levels[0] has the texture's size, each next one half of it
/// (rounded up).
struct LevelState {
    Image values;
    OptimizerState optimizer;
    Image gradient, sum;  ///< work memory of descend, kept for the next step
};
struct TextureParameters {
    std::vector<LevelState> levels;
};

/// Parameters whose texture is `initial` exactly. levels: of the pyramid, at least 1; fewer where
/// the texture is a single texel before.
TextureParameters encode(Parameterization kind, const Image& initial, int levels);

/// One descent step: gradient is dL / d(texture) [height, width, channels]. texture: the one of the
/// parameters before, becomes the one after, clamped to [0, 1].
void descend(const OptimizerOptions& options, const Image& gradient, TextureParameters& parameters,
             Image& texture);

/// The texture: the sum of the upsampled levels, clamped to [0, 1].
Image decode(const TextureParameters& parameters);

}  // namespace burnish
