// The runs that `inverse` compares.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "burnish/checkpoint.h"
#include "experiments/experiments.h"
#include "experiments/figure.h"

namespace burnish {

/// A run as it passes one of its budgets, or two thirds of one. Evaluations are not counted in its
/// seconds.
struct Moment {
    std::uint32_t iteration = 0;
    double seconds = 0;
    double derivative_seconds = 0;  ///< with has_own_derivatives false, of its images too
    double loss = 0;                ///< without the noise of its image
    double noise_floor = 0;         ///< what that noise would add
    double texture_error = 0;
    /// How far the last step moved what it moved, root mean square in units of the learning rate,
    /// after as many iterations as Budget::iterations; otherwise 0.
    double step_length = 0;
    Image image, texture;
};

/// The moments of a run: as it passes each of its budgets, and two thirds of that of the
/// derivative.
enum At : std::size_t { kIterations, kLong, kDerivative, kClock, kLate };
inline constexpr std::size_t kMoments = 5;

struct Run {
    std::array<Moment, kMoments> at;  ///< with image and texture where they are shown
    double seconds = 0;               ///< of all, evaluations included
    /// Of the images of the iterations, over the derivative's time. They hold noise, which falls as
    /// passes gather, also where the textures stay as they are.
    Curve losses;
};

struct Method {
    std::string name;
    Estimator estimator;
    bool is_long = false;  ///< has Budget::long_iterations, not only iterations
    bool is_late = false;  ///< has kLate; without it, that is kDerivative
    std::vector<Run> runs = {};
};

/// The order of the methods.
enum : std::size_t { kMc, kGris, kReplay, kIdentity, kCache };

/// The runs of a scene.
struct InverseRuns {
    std::vector<Method> methods;
};

/// What is to be run: methods without their runs.
InverseRuns planned_runs(const TargetScene& scene, const ReproduceOptions& options);

/// The textures as they are, evaluated with samples that are the same for all. Its times are 0.
Moment evaluate_moment(const TargetScene& scene, const ReproduceOptions& options,
                       const Solver& solver);

/// How a run outlives its process.
struct RunKeeper {
    Checkpoints checkpoints;              ///< stop ends the run before its budgets do
    std::optional<Checkpoint> from = {};  ///< where it goes on; none: it begins
    std::array<std::optional<Moment>, kMoments> moments = {};  ///< that were kept before
    std::function<void(std::size_t at, const Moment&)> keep;   ///< a moment, as the run passes it
};

/// Run k of a method, with a seed of its own. keeper may be null. None: it was stopped, and lies
/// where the keeper keeps it.
std::optional<Run> run_method(const TargetScene& scene, const Method& method,
                              const ReproduceOptions& options, std::uint32_t k,
                              const WorkNote& note, RunKeeper* keeper = nullptr);

/// Run k of a method, made or kept; none: not now.
using GetRun = std::function<std::optional<Run>(const Method& method, std::uint32_t k)>;
/// The runs of all methods, asked for by k, then by method; null where there is none of one.
std::shared_ptr<const InverseRuns> make_runs(const TargetScene& scene,
                                             const ReproduceOptions& options, const GetRun& get);

/// The loss at kDerivative over that at kLate, of each run: below 1 where a run goes on, NaN where
/// both are of the same iteration or noise hides one of them.
std::vector<double> late_changes(const Method& method);

/// The runs of a scene; made on the first call and kept in the scene.
const InverseRuns& runs_of(TargetScene& scene, const ReproduceOptions& options,
                           const WorkNote& note);

}  // namespace burnish
