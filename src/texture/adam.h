// Gradient descent: Adam and SGD over flat arrays. Knows nothing of textures.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/dirty_blocks.h"

namespace burnish {

enum class Optimizer {
    kAdam,
    /// Adam whose steps are shortened where the two halves of a gradient disagree; kAdam where a
    /// gradient is not known in halves.
    kGatedAdam,
    kSgd
};

struct OptimizerOptions {
    Optimizer kind = Optimizer::kAdam;
    float learning_rate = 0.01f;    ///< > 0; step size of Adam in units of the parameter
    float initial_rate = 0;         ///< of the first steps, see rate_at
    std::uint32_t falls_after = 0;  ///< steps, see rate_at; 0: never
    float beta1 = 0.9f;             ///< Adam, [0, 1): decay of the mean of gradients
    float beta2 = 0.999f;           ///< Adam, [0, 1): decay of the mean of squares
    float epsilon = 1e-8f;          ///< Adam, > 0: gradients far below it do not move anything
    float momentum = 0.0f;          ///< SGD, [0, 1)
    /// Adam, >= 0: how fast parameters are drawn back to where OptimizerState::home says, in units
    /// of the rate: the decoupled weight decay of [Loshchilov and Hutter 2019].
    float decay = 0;
    /// kGatedAdam, [0, 1]: the mean agreement of an array below which steps of all of it are
    /// shorter, in proportion; 0: none is.
    float snr_prior = 0;
};

/// A good initial_rate of kGatedAdam, for parameters in [0, 1].
inline constexpr float kInitialRate = 0.02f;

/// Of a segment: how many parameters ever had a gradient, and the sum of their agreement.
struct BlockGate {
    float sum = 0, count = 0;
};

/// What the optimiser remembers of one array of parameters.
struct OptimizerState {
    std::vector<float> first;   ///< mean of gradients (Adam), velocity (SGD)
    std::vector<float> second;  ///< mean of squares (Adam)
    std::vector<float> noise;   ///< mean of squares of the halves' difference (kGatedAdam)
    /// What OptimizerOptions::decay draws parameters to: one value for each, or kDirtyBlock that
    /// repeat; empty: zero.
    std::vector<float> home;
    std::vector<BlockGate> gates;  ///< kGatedAdam with snr_prior
    float mean_gate = 1;                  ///< of the array before this step; 1: of nothing
    std::uint32_t steps = 0;
    DirtyBlocks active;  ///< where a gradient was ever other than zero: nothing else moves
};

/// A gradient: first + second, see SplitGradient. second and reached may be empty.
struct GradientSpans {
    std::span<const float> first, second;
    std::span<const char> reached = {};
};

/// a = max(0, 1 - n / v), of a mean v of squares and a mean n of squares of the halves' difference;
/// 0 where there was no gradient.
inline float snr_gate(float v, float n) { return v > 0 ? std::max(0.0f, 1 - n / v) : 0.0f; }

/// The rate of a step, counted from 1: initial_rate for ten steps, then shorter as 1 / step, down
/// to learning_rate; but never above four times that, so that who asks for slow steps gets them.
/// After falls_after steps all of that shrinks as 1 / step.
inline float rate_at(const OptimizerOptions& o, std::uint32_t step) {
    constexpr float kHold = 10, kMax = 4;
    const float first = std::min(o.initial_rate, kMax * o.learning_rate);
    const auto since = [step](float start) {
        return std::min(1.0f, start / static_cast<float>(step));
    };
    const float fallen = o.falls_after > 0 ? since(static_cast<float>(o.falls_after)) : 1.0f;
    return fallen * std::max(o.learning_rate, first * since(kHold));
}

/// One step of all parameters, at rate_at(steps so far + 1). Adam [Kingma and Ba 2015]: m = b1 m +
/// (1 - b1) g, v = b2 v + (1 - b2) g^2, x -= rate sqrt(1 - b2^t) / (1 - b1^t) m / (sqrt(v) +
/// epsilon) + rate decay (x - home). SGD: v = momentum v + g, x -= rate v.
///
/// kGatedAdam: the step of Adam times agreement(v, n), n = b2 n + (1 - b2) d^2, d the difference of
/// the halves. With a gradient of mean s and variance V, v tends to s^2 + V and n to
/// V, so a to s^2 / (s^2 + V): Wiener's factor. Adam makes a full step of what is only noise; this
/// leaves the parameter where it is until there is evidence.
///
/// snr_prior: times min(1, mean_gate / snr_prior), too. Where an array as a whole
/// agrees on little, most that agrees in it does so by chance.
void step(const OptimizerOptions& options, const GradientSpans& gradient, OptimizerState& state,
          std::span<float> parameters);

/// The same in parts, for work that goes on with the parameters while they are in the cache:
/// begin_step once, then step_part for parts [begin, end) that cover them. begin: a multiple of
/// kDirtyBlock, and so is end, or all parameters end there. Parts may run in parallel.
void begin_step(const OptimizerOptions& options, std::size_t parameters, OptimizerState& state);
void step_part(const OptimizerOptions& options, const GradientSpans& gradient,
               OptimizerState& state, std::span<float> parameters, std::size_t begin,
               std::size_t end);

}  // namespace burnish
