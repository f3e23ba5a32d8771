// Reuse across iterations: the current reservoirs of a parameter and those of the iteration before
// become one pair [PR eq. 12-13, alg. 3]. Generic in the sample.
//
// Both shifts have |dT/dx| = 1 (replay in primary-sample space, identity in path space), so it is
// left out here. A shift with another one needs it in `offer` and, with q_before, in the weights
// [PR eq. 8, 10].
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "gradient/reservoirs/reservoir.h"

namespace burnish {

/// An input y = T(x) of the merge, already shifted to the current iteration.
template <class Sample>
struct MergeInput {
    Sample sample{};  ///< y
    float q_now = 0;  ///< q_v(y), signed
    /// q_{v-1}(y): under the textures and the adjoint of the iteration before, signed.
    float q_before = 0;
    float W = 0;  ///< of x; 0: no sample
};

/// Confidence weights: candidates behind each side. They count every pass of every iteration,
/// whether it hit the parameter or not, and are the same for both signs.
struct Confidence {
    float current = 0;  ///< m
    float history = 0;  ///< min(c, M_cap)
};

/// What each side's sample counts for: m_current(y) + m_history(y) = 1 wherever q_now(y) is not 0,
/// and m_history(y) = 0 where q_before(y), or the history's confidence, is 0: the history cannot
/// hold such a y.
struct MisWeights {
    float current = 0, history = 0;
};

/// The balance heuristic over targets [PR eq. 13]: because |q| = q+ + q- and both signs share a
/// confidence, the sum over the four reservoirs has two terms. 0/0 is 0.
struct BalanceWeights {
    MisWeights operator()(float q_now, float q_before, const Confidence& c) const {
        const double now = double{c.current} * std::fabs(double{q_now});
        const double before = double{c.history} * std::fabs(double{q_before});
        const double sum = now + before;
        if (!(sum > 0)) return {};
        return {static_cast<float>(now / sum), static_cast<float>(before / sum)};
    }
};

/// Never amplifies history: m_history = a min(1, |q_before| / |q_now|), a = c_history / (c_history
/// + c_current).
struct DefensiveWeights {
    MisWeights operator()(float q_now, float q_before, const Confidence& c) const {
        if (q_now == 0 || !(c.current + c.history > 0)) return {};
        const double a = double{c.history} / (double{c.history} + double{c.current});
        const double ratio = std::min(1.0, std::fabs(double{q_before}) / std::fabs(double{q_now}));
        return {static_cast<float>(1 - a * ratio), static_cast<float>(a * ratio)};
    }
};

/// Merges up to two current and two previous samples. u: one uniform in [0, 1) for each input,
/// current ones first. Both previous reservoirs feed both slots: a sample goes where the sign of
/// q_now puts it, whatever it was before.
template <class Sample, class Weights>
ReservoirPair<Sample> merge(std::span<const MergeInput<Sample>> current,
                            std::span<const MergeInput<Sample>> history,
                            const Confidence& confidence, Signs signs, const Weights& weights,
                            std::span<const float> u) {
    ReservoirPairBuilder<Sample> builder;
    std::size_t next = 0;
    const auto offer = [&](const MergeInput<Sample>& y, double m) {
        const double w = m * std::fabs(double{y.q_now}) * double{y.W};
        update(builder.slot[slot_of(signs, y.q_now)], y.sample, y.q_now, w, u[next++]);
    };
    for (const auto& y : current)
        offer(y, double{weights(y.q_now, y.q_before, confidence).current});
    for (const auto& y : history)
        offer(y, double{weights(y.q_now, y.q_before, confidence).history});
    return finish(builder);
}

}  // namespace burnish
