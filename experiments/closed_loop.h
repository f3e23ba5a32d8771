// The bias of an estimator in a closed loop: how far the gradient of a run's last iteration lies,
// on average, from the gradient at its textures.
//
// The textures of a run depend on the samples that its last gradient is made of. Two gradients of
// fresh passes at the same textures, a and b, do not: bias = E<g - a, b> / E<a, b>, the distance
// along the gradient and relative to it.
#pragma once

#include <span>

#include "burnish/solve.h"

namespace burnish {

/// Of one run: <g - a, b> and <a, b>.
struct LoopProducts {
    double error = 0, norm = 0;
};

/// How many passes each half of a and of b has, after so many iterations. The mean of the gradient
/// of Loss::kReweighted changes with the noise of its weights: they have as many as a half of the
/// run's path cache then keeps. 16 under other losses, and of other estimators, where the bias
/// under kReweighted holds that change.
std::uint32_t reference_passes(const Options& options, std::uint32_t iterations);

/// A run of so many iterations on a problem with one unknown. Runs of different `run` are
/// independent.
LoopProducts run_closed_loop(const Problem& problem, Options options, std::uint32_t iterations,
                             std::uint32_t run);

struct LoopBias {
    double bias = 0, standard_error = 0;
};
/// At least two runs.
LoopBias bias_of(std::span<const LoopProducts> runs);

}  // namespace burnish
