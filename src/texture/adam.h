// Adam over flat arrays, with a signal-to-noise gate and decoupled weight decay. Knows nothing of
// textures.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/dirty_blocks.h"
#include "core/exact_sum.h"

namespace burnish {

struct AdamOptions {
    float learning_rate = 0.01f;  ///< > 0; step size in units of the parameter
    float initial_rate = 0;       ///< >= 0: of the first steps, see rate_at
    float beta1 = 0.9f;           ///< [0, 1): decay of the mean of gradients
    float beta2 = 0.999f;         ///< [0, 1): decay of the mean of squares
    bool gate = false;            ///< of a split gradient: steps are multiplied with snr_gate
    /// >= 0: how fast parameters are drawn to AdamState::initial, in units of the rate [Loshchilov
    /// and Hutter 2019].
    float weight_decay = 0;
    /// >= 0: what the roots of mean squares are damped by, in units of their mean over the array.
    float damping = 0;
};

/// Of a block: the sum of the roots of its mean squares, and how many of these are above zero.
struct BlockRoots {
    float sum = 0, count = 0;

    friend bool operator==(const BlockRoots&, const BlockRoots&) = default;
};

/// What Adam remembers of one array of parameters: values only.
struct AdamState {
    std::vector<float> mean;    ///< of gradients
    std::vector<float> square;  ///< mean of squares of gradients
    std::vector<float> noise;   ///< mean of squares of the halves' difference, with the gate
    /// What weight decay draws parameters to: one value for each, or kDirtyBlock that repeat;
    /// empty: zero.
    std::vector<float> initial;
    std::vector<BlockRoots> roots;  ///< with damping
    float mean_root = 0;            ///< of the array before this step; 0: of nothing
    std::uint32_t steps = 0;
    DirtyBlocks visited;  ///< where a gradient was ever other than zero: nothing else moves

    friend bool operator==(const AdamState&, const AdamState&) = default;
};

/// A gradient: first + second, see SplitGradient. second and dirty may be empty.
struct GradientSpans {
    std::span<const float> first, second;
    std::span<const char> dirty = {};
};

/// max(0, 1 - n / v), of a mean v of squares and a mean n of squares of the halves' difference; 0
/// where there was no gradient. With a gradient of mean s and variance V whose halves do not depend
/// on each other, v tends to s^2 + V and n to V, so the gate to s^2 / (s^2 + V): Wiener's factor.
/// Those of a path cache do, which opens it wider: see docs/theory.md.
inline float snr_gate(float v, float n) { return v > 0 ? std::max(0.0f, 1 - n / v) : 0.0f; }

/// The rate of a step, counted from 1: initial_rate for ten steps, then shorter as 1 / step, down
/// to learning_rate; but never above four times that, so that who asks for slow steps gets them.
inline float rate_at(const AdamOptions& o, std::uint32_t step) {
    constexpr float kHold = 10, kMaxFactor = 4;
    const float first = std::min(o.initial_rate, kMaxFactor * o.learning_rate);
    return std::max(o.learning_rate, first * std::min(1.0f, kHold / static_cast<float>(step)));
}

/// The sums of BlockRoots, exact: arrays may be summed up in parts, in any order.
struct RootSum {
    ExactSum sum;
    double count = 0;
};
RootSum root_sum(const AdamState& state);

/// One step of all parameters, at rate_at(steps so far + 1) [Kingma and Ba 2015]:
///
///   m = b1 m + (1 - b1) g       v = b2 v + (1 - b2) g^2       n = b2 n + (1 - b2) d^2
///   x -= rate gate sqrt(1 - b2^t) / (1 - b1^t) m / sqrt(v + (damping mean_root)^2)
///   x -= rate weight_decay (x - initial)
///
/// where v > 0; weight decay acts on all of a block of kDirtyBlock that a gradient has reached.
/// Steps do not depend on the gradient's scale, which falls with the number of texels, as long as
/// its squares are floats, from 1e-19 or so: what is added to v is measured by the array's own
/// sqrt(v), whose mean was mean_root before this step.
///
/// g: the gradient, d: the difference of its halves. gate: 1, or with AdamOptions::gate and a split
/// gradient snr_gate(v, n). Plain Adam makes a full step of what is only noise; the gate leaves the
/// parameter where it is until there is evidence. Adam also makes steps of one length, whether a
/// parameter moves the images much or hardly; damping shortens the steps of those that hardly do,
/// whose gradients are mostly noise.
///
/// roots: of the array, of which these parameters may be some.
void step(const AdamOptions& options, const GradientSpans& gradient, const RootSum& roots,
          AdamState& state, std::span<float> parameters);

/// The same in parts, for work that goes on with the parameters while they are in the cache:
/// begin_step once, then step_part for parts [begin, end) that cover them. begin: a multiple of
/// kDirtyBlock, and so is end, or all parameters end there. Parts may run in parallel.
void begin_step(const AdamOptions& options, std::size_t parameters, const RootSum& roots,
                AdamState& state);
void step_part(const AdamOptions& options, const GradientSpans& gradient, AdamState& state,
               std::span<float> parameters, std::size_t begin, std::size_t end);

}  // namespace burnish
