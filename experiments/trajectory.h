// Derivatives along a scripted sequence of textures. A descent is recorded once; every estimator is
// then run along the same textures and adjoints and judged at the last of them against a converged
// derivative for the same adjoint. So estimators differ by their own noise alone, not by where
// their descents went.
#pragma once

#include "experiments/subject.h"

namespace burnish {

struct Trajectory {
    std::vector<Theta> theta;    ///< of each iteration
    std::vector<Image> adjoint;  ///< dL/dI of each iteration's own noisy image
    double image_seconds = 0;    ///< median of an iteration's image
};

/// The paper's descent of `iterations` steps, and the textures that it arrives at: iterations + 1
/// entries.
Trajectory record_trajectory(const Subject& subject, const ReproduceOptions& options,
                             const SolveOptions& solve, const Progress& progress = {});

/// An estimate at the last entry, and the seconds of its derivative stage there.
struct DerivativeEstimate {
    Image gradient;  ///< [height, width, channels] of the texture
    double seconds = 0;
};
/// The most camera samples of the baseline that are drawn at once: each takes up to a kilobyte
/// until its derivatives are summed.
inline constexpr std::size_t kMaxAtOnce = std::size_t{1} << 22;
/// What has_state runs along the whole trajectory. The uniform baseline is the mean of estimates
/// with as many passes as `max_at_once` allows, so that its memory does not grow with its samples.
DerivativeEstimate estimate_along(const TracedScene& scene, const Trajectory& trajectory,
                                  const GradientOptions& options, const Progress& progress = {},
                                  std::size_t max_at_once = kMaxAtOnce);

/// The same for a pool, whose image is its own: the seconds are those of tracing, shading and
/// differentiating.
DerivativeEstimate estimate_pool_along(const TracedScene& scene, const Trajectory& trajectory,
                                       const PoolOptions& options, std::uint32_t seed,
                                       const Progress& progress = {});

/// Seconds of the baseline's derivative stage at the last entry: that of one sample per pixel, and
/// what each further one adds.
struct CostLine {
    double first = 0, each = 0;
};
CostLine baseline_cost(const Subject& subject, const Trajectory& trajectory,
                       GradientOptions options);
/// The most samples per pixel that take at most `seconds`, from 1 to `most`.
std::uint32_t affordable_samples(const CostLine& cost, double seconds, std::uint32_t most = 256);

/// The converged derivative at the last entry.
struct DerivativeReference {
    Image gradient;
    double nmse = 0;  ///< of the reference itself, from its two halves; infinite where all is noise
};
DerivativeReference converged_derivative(const Subject& subject, const Trajectory& trajectory,
                                         std::uint32_t samples_per_pixel, std::uint32_t seed,
                                         const Progress& progress = {});

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
