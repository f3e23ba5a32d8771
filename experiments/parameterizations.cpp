#include "experiments/parameterizations.h"

#include <algorithm>

#include "texture/coverage.h"

namespace burnish {

namespace {

/// The library's defaults, at the paper's learning rate.
Options run_options(const TargetScene& scene, const ReproduceOptions& options,
                    Parameterization kind) {
    Options run;
    run.estimator = PathCache{};
    run.parameterization = kind;
    run.learning_rate = double{scene.source.learning_rate};
    run.seed = options.seed;
    return run;
}

double error_of(const TargetScene& scene, const Solver& solver) {
    return texture_error(solver.texture(0), scene.truth, scene.visited);
}

}  // namespace

ParameterizationStudy study_parameterizations(const TargetScene& scene,
                                              const ReproduceOptions& options,
                                              const WorkNote& note) {
    ParameterizationStudy study;
    const auto loss_of = [&](const Solver& solver) {
        return loss_without_noise(solver.evaluate(options.evaluation_samples));
    };
    for (const auto& [name, kind] : {std::pair{"texels", Parameterization::kTexels},
                                     {"pyramid", Parameterization::kPyramid}}) {
        note(scene.source.name + ": a run of the path cache with the parameterization " + name);
        const Options run = run_options(scene, options, kind);
        Solver solver(problem_of(scene), run);
        if (study.ends.empty()) {
            study.loss = loss_of(solver);
            study.texture_error = error_of(scene, solver);
            study.truth_loss = loss_of(Solver(problem_of(scene, scene.truth), run));
        }
        const double seconds = options.sweep_seconds;
        step_for(solver, seconds, [&](double spent, const Iteration&) {
            if (note.share) note.share(std::min(1.0, spent / seconds));
        });
        study.ends.push_back({name, solver.iterations(), loss_of(solver), error_of(scene, solver)});
    }
    return study;
}

}  // namespace burnish
