// What the optimiser moves: plain texels, which the paper's figures have, beside the
// pyramid, whose levels share evidence between texels.
#pragma once

#include "experiments/experiments.h"
#include "experiments/figure.h"

namespace burnish {

/// How a run of the path cache ended, with one parameterization.
struct ParameterizationEnd {
    std::string name;
    std::uint32_t iterations = 0;
    double loss = 0;  ///< without the noise of its image
    double texture_error = 0;
};
struct ParameterizationStudy {
    double loss = 0, texture_error = 0;  ///< at the start
    double truth_loss = 0;               ///< of the true texture: the noise of the target
    std::vector<ParameterizationEnd> ends;
};

/// A run of options.sweep_seconds with each, from the same start, as `burnish optimize` makes it.
ParameterizationStudy study_parameterizations(const TargetScene& scene,
                                              const ReproduceOptions& options,
                                              const WorkNote& note);

/// What is left of the loss at the start, without the noise of the target, as a share of at least
/// 0; NaN where that noise is all of it.
double left_of(const ParameterizationStudy& study, const ParameterizationEnd& end);
/// Start and ends, a row each.
Table parameterization_table(const ParameterizationStudy& study);
/// The same in a sentence. seconds: of each run.
std::string parameterization_text(const ParameterizationStudy& study, double seconds);
/// Appends the numbers of the ends.
void measure(ExperimentResult& result, const std::string& scene,
             const ParameterizationStudy& study);

}  // namespace burnish
