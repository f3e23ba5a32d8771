// Derivatives along a scripted sequence of textures. An optimisation run is recorded once; every
// estimator then goes along the same textures and adjoints, and is evaluated at the last of them
// against a converged derivative for the same adjoint. So estimators differ by their own noise
// alone, not by where their runs went.
#pragma once

#include <optional>

#include "experiments/target_scene.h"
#include "gradient/estimator.h"

namespace burnish {

struct Trajectory {
    std::vector<Theta> theta;    ///< of each iteration
    std::vector<Image> adjoint;  ///< dL/dI of each iteration's own noisy image
    double image_seconds = 0;    ///< median of an iteration's image
};

/// A run of so many steps under options of an estimator with one image, and the textures that it
/// arrives at: iterations + 1 entries.
Trajectory record_trajectory(const TargetScene& scene, const Options& options,
                             std::uint32_t iterations, const Progress& progress = {});

/// An estimator on its way along a script, and what it keeps between iterations.
struct ScriptedEstimator {
    Estimator estimator;
    std::uint32_t seed = 0;
    EstimatorState state;
    std::optional<EstimatorWorkspace> workspace = {};

    ScriptedEstimator(const Estimator& e, std::uint32_t s)
        : estimator(e), seed(s), state(make_state(e)) {}
};
/// The gradient [height, width, channels] of the next iteration of the script, which has one
/// texture. An estimator that differentiates the samples of its image makes that image first.
Image estimate_next(const TracedScene& scene, const Theta& theta, const Image& adjoint,
                    std::uint32_t iteration, ScriptedEstimator& along);

/// An estimate at the last entry.
struct DerivativeEstimate {
    Image gradient;      ///< [height, width, channels] of the texture
    double seconds = 0;  ///< of the derivative; with has_own_derivatives false, of its image too
};
/// The most camera samples of the baseline that are drawn at once: each takes up to a kilobyte
/// until its derivatives are summed, and more of them take longer, each.
inline constexpr std::size_t kMaxAtOnce = std::size_t{1} << 21;
/// Of an estimate that is repeated for its time.
inline constexpr double kEnoughSeconds = 5;
/// What an estimator gives at the end of a trajectory. One that keeps something between iterations
/// goes along all of it; another is asked at the last entry alone, up to five times for its seconds
/// until they are `enough_seconds`. The uniform baseline is the mean of estimates with as many
/// passes as `max_at_once` allows, so that its memory does not grow with its samples.
DerivativeEstimate estimate_along(const TracedScene& scene, const Trajectory& trajectory,
                                  const Estimator& estimator, std::uint32_t seed,
                                  const Progress& progress = {},
                                  std::size_t max_at_once = kMaxAtOnce,
                                  double enough_seconds = kEnoughSeconds);

/// Seconds of the baseline's derivative stage at the last entry: that of one sample per pixel, and
/// what each further one adds.
struct CostLine {
    double first = 0, each = 0;
};
CostLine baseline_cost(const TracedScene& scene, const Trajectory& trajectory, std::uint32_t seed);
/// The most samples per pixel that take at most `seconds`, from 1 to `max`.
std::uint32_t affordable_samples(const CostLine& cost, double seconds, std::uint32_t max = 256);

/// The converged derivative at the last entry.
struct DerivativeReference {
    Image gradient;
    double squared_error = 0;  ///< its own, summed over the texels: from two independent halves
    double nmse = 0;           ///< its own; infinite where all is noise
};
DerivativeReference converged_derivative(const TracedScene& scene, const Trajectory& trajectory,
                                         std::uint32_t samples_per_pixel, std::uint32_t seed,
                                         const Progress& progress = {});

/// A trajectory with the converged derivative at its end.
struct Study {
    Trajectory trajectory;
    DerivativeReference reference;
};

/// Errors of an estimate a against a reference b, over all texels and channels. The sums of squares
/// (a - b)^2 and b^2 hold the reference's own squared error s, on average; the NMSE is without it,
/// the two other measures are with it.
struct DerivativeError {
    double paper = 0;            ///< sum (a - b)^2 / (b^2 + 0.01) / count(b != 0), the paper's
    double nmse = 0;             ///< see normalized_error
    double median_relative = 0;  ///< median of |a - b| / |b| over texels with b != 0
};
DerivativeError derivative_error(const Image& a, const DerivativeReference& reference);
/// (squared - s) / (power - s) of sums (a - b)^2 and b^2, s being the reference's own squared
/// error; NaN unless both are above 0: noise hides the error.
double normalized_error(double squared, double power, double s);

/// What is told of an estimate.
struct EstimateNumbers {
    double seconds = 0;  ///< as of DerivativeEstimate
    DerivativeError error = {};
};

}  // namespace burnish
