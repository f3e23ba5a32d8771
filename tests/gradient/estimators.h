// The estimators whose gradients come texel by texel, by the names that the paper gives them, with
// as many samples into every pixel.
#pragma once

#include <string>

#include "gradient/estimator.h"

namespace burnish::test {

inline MonteCarlo mc(std::uint32_t samples = 1) {
    return {.samples = samples, .adaptive_sampling = false};
}

inline Reservoirs reservoirs(bool positivization, bool reuse) {
    return {.adaptive_sampling = false, .positivization = positivization, .reuse = reuse};
}
inline Reservoirs ris() { return reservoirs(false, false); }
inline Reservoirs pris() { return reservoirs(true, false); }
inline Reservoirs gris() { return reservoirs(false, true); }
inline Reservoirs pgris() { return reservoirs(true, true); }

inline std::string name_of(const Estimator& estimator) {
    const auto* o = std::get_if<Reservoirs>(&estimator);
    if (!o) return std::holds_alternative<MonteCarlo>(estimator) ? "mc" : "path cache";
    return std::string(o->positivization ? "p" : "") + (o->reuse ? "gris" : "ris");
}
/// By the identity shift, which takes the integrand as its target function.
inline Reservoirs by_integrand(Reservoirs options) {
    options.shift = Shift::kIdentity;
    options.target_function = TargetFunction::kIntegrand;
    return options;
}

inline const char* name_of(Shift shift) { return shift == Shift::kReplay ? "replay" : "identity"; }

/// One estimate. state: make_state(estimator) in the first iteration.
inline GradientResult estimate(const Estimator& estimator, const Binding& binding,
                               const Image& adjoint, IterationKey key, EstimatorState& state) {
    if (const auto* mc = std::get_if<MonteCarlo>(&estimator))
        return estimate_gradient(*mc, binding, adjoint, key.seed, key.iteration,
                                 std::get<MonteCarloState>(state));
    return estimate_gradient(std::get<Reservoirs>(estimator), binding, adjoint, key.seed,
                             key.iteration, std::get<ReservoirsState>(state));
}

/// The estimate of the first iteration.
inline GradientResult estimate_first(const Estimator& estimator, const Binding& binding,
                                     const Image& adjoint, std::uint32_t seed) {
    EstimatorState state = make_state(estimator);
    return estimate(estimator, binding, adjoint, {seed, 0}, state);
}

}  // namespace burnish::test
