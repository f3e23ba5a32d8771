#include "experiments/experiments.h"

#include <limits>

namespace burnish {

std::span<const Experiment> experiments() {
    constexpr auto kAll = std::numeric_limits<std::size_t>::max();
    static constexpr Experiment kExperiments[] = {
        {"derivatives", "Derivative error at equal time", kAll, kAll, Needs::kStudy,
         run_derivatives},
        {"inverse", "Inverse rendering at equal time", kAll, kAll, Needs::kRuns, run_inverse},
        {"ablation", "What each part contributes", kAll, 3, Needs::kStudy, run_ablation},
        {"positivization", "Positivization in one dimension", 0, 0, Needs::kNothing,
         run_positivization},
        // Twenty-seven runs for each scene.
        {"adam", "The optimiser", 3, 3, Needs::kStudy, run_adam},
        {"equal-error", "What the baseline needs for the same error", kAll, kAll, Needs::kStudy,
         run_equal_error},
    };
    return kExperiments;
}

std::shared_ptr<const Study> make_study(const TargetScene& scene, const ReproduceOptions& options,
                                        const WorkNote& note,
                                        const std::optional<DerivativeReference>& reference) {
    auto study = std::make_shared<Study>();
    note(scene.source.name + ": a run of " + std::to_string(options.iterations) + " iterations");
    study->trajectory =
        record_trajectory(scene, paper_options(scene, options), options.iterations, note.share);
    if (reference) {
        study->reference = *reference;
        return study;
    }
    note(scene.source.name + ": the converged derivative");
    study->reference = converged_derivative(scene.traced(), study->trajectory,
                                            options.reference_samples, options.seed, note.share);
    return study;
}

const Study& study_of(TargetScene& scene, const ReproduceOptions& options, const WorkNote& note) {
    if (!scene.study) scene.study = make_study(scene, options, note);
    return *scene.study;
}

void measure(ExperimentResult& result, const std::string& scene, const std::string& variant,
             const EstimateNumbers& numbers) {
    const auto add = [&](const char* metric, double value) {
        result.measurements.push_back({result.name, scene, variant, metric, value});
    };
    add("paper_error", numbers.error.paper);
    add("nmse", numbers.error.nmse);
    add("median_relative_error", numbers.error.median_relative);
    add("derivative_seconds", numbers.seconds);
}

}  // namespace burnish
