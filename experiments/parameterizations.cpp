#include "experiments/parameterizations.h"

#include <algorithm>

#include "texture/coverage.h"

namespace burnish {

namespace {

/// As `optimize` does without further options: by agreement where texels share evidence.
SolveOptions solve_options(const Subject& subject, const ReproduceOptions& options,
                           Parameterization kind) {
    SolveOptions solve = paper_options(subject, options);
    solve.gradient.estimator = Estimator::kPool;
    solve.parameterization.kind = kind;
    if (kind == Parameterization::kTexels) return solve;
    solve.optimizer.kind = Optimizer::kGatedAdam;
    solve.optimizer.initial_rate = kInitialRate;
    return solve;
}

double loss_of(const Subject& subject, const SolveOptions& solve, const ReproduceOptions& options,
               const Theta& theta) {
    return evaluate(subject.problem, solve, theta, options.evaluation_samples, 0).loss;
}

}  // namespace

ParameterizationStudy study_parameterizations(const Subject& subject,
                                              const ReproduceOptions& options, const Note& note) {
    ParameterizationStudy study;
    for (const auto& [name, kind] : {std::pair{"texels", Parameterization::kTexels},
                                     {"pyramid", Parameterization::kPyramid},
                                     {"smooth", Parameterization::kSmooth}}) {
        note(subject.source.name + ": a descent of a pool with the parameterization " + name);
        const SolveOptions solve = solve_options(subject, options, kind);
        SolveState state = start_gray(subject, solve);
        const auto error = [&] {
            return texture_error(state.theta.textures[0].values, subject.truth, subject.reached);
        };
        if (study.ends.empty()) {
            study.loss = loss_of(subject, solve, options, state.theta);
            study.texture_error = error();
            study.truth_loss =
                loss_of(subject, solve, options, {{{subject.texture, subject.truth}}});
        }
        const double seconds = options.sweep_seconds;
        descend_for(subject, solve, seconds, state, [&](double spent, const IterationReport&) {
            if (note.share) note.share(std::min(1.0, spent / seconds));
        });
        study.ends.push_back(
            {name, state.iteration, loss_of(subject, solve, options, state.theta), error()});
    }
    return study;
}

}  // namespace burnish
