// What the optimiser moves: plain texels, which the paper's figures have, beside those
// parameterizations that share evidence between texels.
#pragma once

#include "experiments/experiments.h"
#include "experiments/figure.h"

namespace burnish {

/// How a descent by pools ended, with one parameterization.
struct ParameterizationEnd {
    std::string name;
    std::uint32_t iterations = 0;
    double loss = 0, texture_error = 0;
};
struct ParameterizationStudy {
    double loss = 0, texture_error = 0;  ///< at the start
    double truth_loss = 0;               ///< of the true texture: the noise of judging
    std::vector<ParameterizationEnd> ends;
};

/// A descent of options.sweep_seconds with each, from the same start, as `optimize` makes it.
ParameterizationStudy study_parameterizations(const Subject& subject,
                                              const ReproduceOptions& options, const Note& note);

}  // namespace burnish
