// Gradients alone, for an optimiser or a study of your own.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "burnish/renderer.h"

namespace burnish {

/// Of detached Monte Carlo at given textures.
struct GradientOptions {
    std::uint32_t samples = 64;   ///< per pixel, at least 1
    std::uint32_t seed = 0;       ///< independent of the numbers of a picture with the same seed
    TextureValues textures = {};  ///< in the place of the scene's
};

/// dL/d(texture) of each parameter, [height, width, channels], for a loss L with the adjoint
/// dL/dI [height, width, 3]: for an optimiser of your own. Unbiased for this adjoint; where it
/// comes from a noisy picture, the expectation is that over pictures. The same bytes for any number
/// of threads. Throws InputError: no parameter, one twice, or one that is no texture or cannot be
/// recovered (see Renderer::parameters); `textures` that Renderer::render refuses; an adjoint of
/// another size, without one value for each channel, or with one that is not finite; no sample.
/// Contributions that are not finite are left out; where they are more than one in 1000, or the
/// gradient is not finite, values are too large: InputError, too.
std::vector<Image> estimate_gradient(const Renderer& renderer,
                                     const std::vector<std::string>& parameters,
                                     const Image& adjoint, const GradientOptions& options = {},
                                     const Progress& progress = {});

}  // namespace burnish
