// The paper's experiments, one function each.
//
// To add one: a function here, its file NAME.cpp, and a row in experiments.cpp.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "experiments/figure.h"
#include "experiments/target_scene.h"
#include "experiments/trajectory.h"

namespace burnish {

using TargetScenes = std::span<TargetScene>;
/// What is kept under a name, or made and kept.
template <class T>
using Get = std::function<T(const std::string& name, const std::function<T()>& make)>;
/// Is told of the work that is under way, and keeps what takes long.
struct WorkNote {
    std::function<void(const std::string&)> begin;  ///< what begins, in a few words
    Progress share;  ///< the share of it that is done, where the work knows; may be empty
    Get<EstimateNumbers> numbers = {};        ///< of an estimate; empty: nothing is kept
    Get<DerivativeReference> reference = {};  ///< at the end of a trajectory; likewise
    void operator()(const std::string& text) const { begin(text); }
};

/// Derivative error at equal time [PR fig. 1, 4-6 (b)].
ExperimentResult run_derivatives(TargetScenes scenes, const ReproduceOptions& options,
                                 const WorkNote& note);
/// Loss over time, side by side [PR fig. 1, 4-6 (c), (d)].
ExperimentResult run_inverse(TargetScenes scenes, const ReproduceOptions& options,
                             const WorkNote& note);
/// What each part of the method contributes [PR fig. 7].
ExperimentResult run_ablation(TargetScenes scenes, const ReproduceOptions& options,
                              const WorkNote& note);
/// One-dimensional integrands whose sign changes [PR eq. 7, 11; fig. 3]. Needs no scene.
ExperimentResult run_positivization(TargetScenes scenes, const ReproduceOptions& options,
                                    const WorkNote& note);
/// The decay rates of Adam, and what the correlation of reused gradients does to it [PR sec. 5].
ExperimentResult run_adam(TargetScenes scenes, const ReproduceOptions& options,
                          const WorkNote& note);
/// What the baseline needs to reach the error of pgris.
ExperimentResult run_equal_error(TargetScenes scenes, const ReproduceOptions& options,
                                 const WorkNote& note);

/// What an experiment takes from its scene beside the target, which takes long and can be kept.
enum class Needs { kNothing, kStudy, kRuns };

struct Experiment {
    const char* name;
    const char* title;
    std::size_t max_scenes;   ///< it runs on so many at most unless scenes are named; 0: on none
    std::size_t full_scenes;  ///< on so many at the paper's size
    Needs needs;              ///< kStudy: calls study_of; kRuns: runs_of
    ExperimentResult (*run)(TargetScenes, const ReproduceOptions&, const WorkNote&);
};
std::span<const Experiment> experiments();

/// The paper's trajectory of a target texture and the converged derivative at its end. reference:
/// that of an earlier run with these options, which is taken.
std::shared_ptr<const Study> make_study(const TargetScene& scene, const ReproduceOptions& options,
                                        const WorkNote& note,
                                        const std::optional<DerivativeReference>& reference = {});
/// The study of a scene; made on the first call and kept in the scene.
const Study& study_of(TargetScene& scene, const ReproduceOptions& options, const WorkNote& note);

/// Appends the three error measures and the seconds of an estimate.
void measure(ExperimentResult& result, const std::string& scene, const std::string& variant,
             const EstimateNumbers& numbers);

}  // namespace burnish
