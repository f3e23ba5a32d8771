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

/// A run as it passes one of its budgets. Evaluations are not counted in its seconds.
struct Moment {
    std::uint32_t iteration = 0;
    double seconds = 0, derivative_seconds = 0;
    double loss = 0;         ///< without the noise of its image
    double noise_floor = 0;  ///< what that noise would add
    double texture_error = 0;
    /// How far the last step moved what it moved, root mean square in units of the learning rate,
    /// after as many iterations as Budget::iterations; otherwise 0.
    double step_length = 0;
    Image image, texture;
};

/// The budgets, in the order of a run's moments.
enum At : std::size_t { kIterations, kLong, kDerivative, kClock };
inline constexpr std::size_t kMoments = 4;

struct Run {
    std::array<Moment, kMoments> at;  ///< with image and texture where they are shown
    double seconds = 0;               ///< of all, evaluations included
    Curve losses;  ///< of the images of the iterations, noise included, over the derivative's time
};

struct Method {
    std::string name;
    Estimator estimator;
    bool is_long = false;  ///< has Budget::long_iterations, not only iterations
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
/// The runs of all methods; null where there is none of one.
std::shared_ptr<const InverseRuns> make_runs(const TargetScene& scene,
                                             const ReproduceOptions& options, const GetRun& get);

/// The mean loss of the last sixth of the derivative's time over that of the sixth before, of each
/// run: below 1 where a run goes on, NaN where no iteration ends in one of them.
std::vector<double> late_changes(const Method& method, const Budget& budget);

/// The runs of a scene; made on the first call and kept in the scene.
const InverseRuns& runs_of(TargetScene& scene, const ReproduceOptions& options,
                           const WorkNote& note);

}  // namespace burnish
