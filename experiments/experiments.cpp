#include "experiments/experiments.h"

namespace burnish {

std::span<const Experiment> experiments() {
    static constexpr Experiment kExperiments[] = {
        {"derivatives", "Derivative error at equal time", true, run_derivatives},
        {"inverse", "Inverse rendering at equal time", true, run_inverse},
        {"ablation", "What each part contributes", true, run_ablation},
        {"positivization", "Positivization in one dimension", false, run_positivization},
        {"adam", "The optimiser", true, run_adam},
        {"equal-error", "What the baseline needs for the same error", true, run_equal_error},
    };
    return kExperiments;
}

const Study& study_of(TargetScene& scene, const ReproduceOptions& options, const Note& note) {
    if (!scene.study) {
        auto study = std::make_shared<Study>();
        note(scene.source.name + ": a run of " + std::to_string(options.iterations) +
             " iterations");
        study->trajectory =
            record_trajectory(scene, paper_options(scene, options), options.iterations, note.share);
        note(scene.source.name + ": the converged derivative");
        study->reference = converged_derivative(
            scene.traced(), study->trajectory, options.reference_samples, options.seed, note.share);
        scene.study = std::move(study);
    }
    return *scene.study;
}

void measure(ExperimentResult& result, const std::string& scene, const std::string& variant,
             const DerivativeEstimate& estimate, const DerivativeError& error) {
    const auto add = [&](const char* metric, double value) {
        result.measurements.push_back({result.name, scene, variant, metric, value});
    };
    add("paper_error", error.paper);
    add("nmse", error.nmse);
    add("median_relative_error", error.median_relative);
    add("derivative_seconds", estimate.seconds);
}

}  // namespace burnish
