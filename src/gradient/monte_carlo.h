// Detached Monte Carlo: the gradient as the sum over fresh samples, the baseline of the paper.
#pragma once

#include "gradient/candidates.h"
#include "gradient/path_cache/path_cache.h"
#include "gradient/texel_gradient.h"

namespace burnish {

/// What the next iteration reads: values only.
struct MonteCarloState {
    PixelStatistics pixels;  ///< with MonteCarlo::adaptive_sampling
    PathCacheState image;    ///< with MonteCarlo::image_window

    friend bool operator==(const MonteCarloState&, const MonteCarloState&) = default;
};

/// One estimate for the adjoint dL/dI [crop_height, crop_width, 3].
GradientResult estimate_gradient(const MonteCarlo& options, const Binding& binding,
                                 const Image& adjoint, std::uint32_t seed, std::uint32_t iteration,
                                 MonteCarloState& state);

}  // namespace burnish
