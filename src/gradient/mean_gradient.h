// The gradient at textures that stay as they are: the mean of many small estimates, so that memory
// does not grow with the number of samples.
#pragma once

#include <functional>

#include "gradient/estimator.h"

namespace burnish {

struct MeanGradientOptions {
    Estimator estimator = MonteCarlo{};  ///< with derivatives of its own: has_own_derivatives
    std::uint32_t samples = 64;          ///< per pixel, in place of the estimator's; at least 1
    std::uint32_t seed = 0;
};

/// Hears of each estimate: its counts, its number from 0, and how many there will be.
using EstimateReport =
    std::function<void(const GradientCounts& counts, std::uint32_t number, std::uint32_t count)>;

/// dL / d(texture), [height, width, channels], one per texture of theta, for the adjoint dL/dI
/// [crop_height, crop_width, 3]. As many samples in every pixel, and no reservoir of an estimate
/// before: one adjoint has no history.
/// Throws InputError: no sample, or an estimator without derivatives of its own.
std::vector<Image> mean_gradient(const MeanGradientOptions& options, const Binding& binding,
                                 const Image& adjoint, const EstimateReport& report = {});

}  // namespace burnish
