// Derivatives along a scripted sequence of textures. A descent is recorded once; every estimator is
// then run along the same textures and adjoints and judged at the last of them against a converged
// derivative for the same adjoint. So estimators differ by their own noise alone, not by where
// their descents went.
#pragma once

#include "burnish/reproduce/subject.h"

namespace burnish {

struct Trajectory {
    std::vector<Theta> theta;    ///< of each iteration
    std::vector<Image> adjoint;  ///< dL/dI of each iteration's own noisy image
    double image_seconds = 0;    ///< median of an iteration's image
};

/// The paper's descent of `iterations` steps, and the textures that it arrives at: iterations + 1
/// entries.
Trajectory record_trajectory(const Subject& subject, const ReproduceOptions& options,
                             const SolveOptions& solve);

/// An estimate at the last entry, and the seconds of its derivative stage there.
struct DerivativeEstimate {
    Image gradient;  ///< [height, width, channels] of the texture
    double seconds = 0;
};
/// Estimators with a history run along the whole trajectory.
DerivativeEstimate estimate_along(const Subject& subject, const Trajectory& trajectory,
                                  const GradientOptions& options);

/// The converged derivative at the last entry.
struct DerivativeReference {
    Image gradient;
    double nmse = 0;  ///< of the reference itself, from its two halves; infinite where all is noise
};
DerivativeReference converged_derivative(const Subject& subject, const Trajectory& trajectory,
                                         std::uint32_t samples_per_pixel, std::uint32_t seed);

/// A trajectory with the converged derivative at its end.
struct Study {
    Trajectory trajectory;
    DerivativeReference reference;
};

/// Errors of an estimate a against a reference b, over all texels and channels.
struct DerivativeError {
    double paper = 0;            ///< sum (a - b)^2 / (b^2 + 0.01) / count(b != 0), the paper's
    double nmse = 0;             ///< sum (a - b)^2 / sum b^2
    double median_relative = 0;  ///< median of |a - b| / |b| over texels with b != 0
};
DerivativeError derivative_error(const Image& a, const Image& b);

}  // namespace burnish
