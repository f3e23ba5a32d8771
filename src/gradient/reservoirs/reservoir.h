// Weighted reservoirs for integrals of signed functions, generic in the sample.
//
// A reservoir keeps one sample y_z of a stream with weights w_s, chosen with probability w_z / sum
// w, and the unbiased contribution weight W = sum w / |q(y_z)| [PR eq. 8]: for any f whose support
// lies in that of q, E[f(y_z) W] is the integral of f over the slot's part of the domain.
// Positivisation [PR eq. 11] keeps two: one for q > 0, one for q < 0.
#pragma once

#include <cmath>

namespace burnish {

/// A reservoir in the making [PR alg. 1]. weight_sum is not W.
template <class Sample>
struct ReservoirBuilder {
    Sample sample{};
    float q = 0;            ///< signed target value of the kept sample
    double weight_sum = 0;  ///< sum of all weights offered
};

/// A finished reservoir; W = 0 means empty.
template <class Sample>
struct Reservoir {
    Sample sample{};
    float q = 0;  ///< signed target value under which the sample was chosen
    float W = 0;  ///< unbiased contribution weight; needs no pdf any more
};

/// Offers a sample with target value q and weight > 0; u is uniform in [0, 1). Where there are
/// millions of samples it needs more random bits than a float has: fine_uniform. Keeps the sample
/// with probability w / sum w, the sum *including* w. Weights that are zero, negative or not finite
/// are ignored: the caller counts them.
template <class Sample>
void update(ReservoirBuilder<Sample>& builder, const Sample& sample, float q, double weight,
            double u) {
    if (!(weight > 0) || !std::isfinite(weight)) return;
    builder.weight_sum += weight;
    if (u * builder.weight_sum < weight) {
        builder.sample = sample;
        builder.q = q;
    }
}

template <class Sample>
Reservoir<Sample> finish(const ReservoirBuilder<Sample>& builder) {
    if (!(builder.weight_sum > 0)) return {};
    return {builder.sample, builder.q,
            static_cast<float>(builder.weight_sum / std::fabs(double{builder.q}))};
}

/// How signs are treated.
enum class Signs {
    kPositivized,  ///< two reservoirs, one per sign of q [PR eq. 11, 12]
    kAbsolute,     ///< one reservoir with |q|
};

/// The reservoirs of one parameter. Signs::kAbsolute uses slot 0 only.
template <class Sample>
struct ReservoirPair {
    Reservoir<Sample> slot[2];  ///< [0]: q > 0 (or |q|), [1]: q < 0
};

template <class Sample>
struct ReservoirPairBuilder {
    ReservoirBuilder<Sample> slot[2];
};

inline int slot_of(Signs signs, float q) { return signs == Signs::kPositivized && q < 0 ? 1 : 0; }

template <class Sample>
ReservoirPair<Sample> finish(const ReservoirPairBuilder<Sample>& builder) {
    return {{finish(builder.slot[0]), finish(builder.slot[1])}};
}

/// The estimate of the integral of f: sum over the slots of f(y_z) W [PR eq. 11]. f: Sample ->
/// Value; zero: the sum of none.
template <class Sample, class Function, class Value>
Value estimate(const ReservoirPair<Sample>& pair, Function&& f, Value zero) {
    for (const Reservoir<Sample>& r : pair.slot)
        if (r.W > 0) zero = zero + f(r.sample) * r.W;
    return zero;
}

}  // namespace burnish
