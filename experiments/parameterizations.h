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

}  // namespace burnish
