#include "texture/adam.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/pages.h"
#include "core/parallel.h"

namespace burnish {

namespace {

/// Arrays of `count` parameters that do not overlap.
struct StepArrays {
    std::size_t count = 0;
    const float* gradient = nullptr;
    const float* difference = nullptr;  ///< of the gradient's halves
    float* mean = nullptr;
    float* square = nullptr;
    float* noise = nullptr;
    float* parameters = nullptr;
    const float* initial = nullptr;  ///< null: zero
};

/// Without the gate neither the difference nor the noise is read. damping: of v.
template <bool kGate>
void adam(const AdamOptions& o, float rate, float damping, const StepArrays& a) {
    const float* __restrict g = a.gradient;
    const float* __restrict d = a.difference;
    float* __restrict m = a.mean;
    float* __restrict v = a.square;
    float* __restrict n = a.noise;
    float* __restrict x = a.parameters;
    const float b1 = o.beta1, b2 = o.beta2;
    std::array<float, kDirtyBlock> steps;
    for (std::size_t i = 0; i < a.count; ++i) {
        m[i] = b1 * m[i] + (1 - b1) * g[i];
        v[i] = b2 * v[i] + (1 - b2) * g[i] * g[i];
        if constexpr (kGate) {
            n[i] = b2 * n[i] + (1 - b2) * d[i] * d[i];
            steps[i] = rate * snr_gate(v[i], n[i]);
        } else {
            steps[i] = v[i] > 0 ? rate : 0.0f;
        }
    }
    // A loop of its own, without conditions, vectorises.
    constexpr float kMin = std::numeric_limits<float>::min();
    for (std::size_t i = 0; i < a.count; ++i)
        x[i] -= steps[i] * m[i] / std::sqrt(std::max(v[i] + damping, kMin));
}

float sum_of(std::array<float, kDirtyBlock> values) {
    static_assert(kDirtyBlock == 48);
    for (std::size_t n = kDirtyBlock / 2; n >= 3; n /= 2)
        for (std::size_t i = 0; i < n; ++i) values[i] += values[i + n];
    return values[0] + values[1] + values[2];
}

BlockRoots roots_of(const StepArrays& a) {
    std::array<float, kDirtyBlock> sum{}, count{};
    for (std::size_t i = 0; i < a.count; ++i) {
        sum[i] = std::sqrt(a.square[i]);
        count[i] = a.square[i] > 0 ? 1.0f : 0.0f;
    }
    return {sum_of(sum), sum_of(count)};
}

/// share: of the way back.
void decay(float share, const StepArrays& a) {
    static constexpr std::array<float, kDirtyBlock> kZeros{};
    float* __restrict x = a.parameters;
    const float* __restrict initial = a.initial ? a.initial : kZeros.data();
    for (std::size_t i = 0; i < a.count; ++i) x[i] -= share * (x[i] - initial[i]);
}

/// The learning rate with the correction for means that began at zero.
float corrected_rate(const AdamOptions& o, std::uint32_t steps) {
    const double t = steps;
    return static_cast<float>(double{rate_at(o, steps)} *
                              std::sqrt(1 - std::pow(double{o.beta2}, t)) /
                              (1 - std::pow(double{o.beta1}, t)));
}

/// Of the block that begins at i; null: zero.
const float* initial_at(const std::vector<float>& initial, std::size_t i) {
    if (initial.empty()) return nullptr;
    return initial.size() == kDirtyBlock ? initial.data() : &initial[i];
}

/// The sum and the difference of a block's halves.
struct BlockGradient {
    std::array<float, kDirtyBlock> sum{}, difference{};
};

/// Whether any of it is other than zero.
bool read_block(const GradientSpans& gradient, std::size_t begin, std::size_t count,
                BlockGradient& block) {
    const float* __restrict a = gradient.first.data() + begin;
    const bool split = !gradient.second.empty();
    const float* __restrict b = split ? gradient.second.data() + begin : nullptr;
    for (std::size_t i = 0; i < count; ++i) {
        const float other = split ? b[i] : 0.0f;
        block.sum[i] = a[i] + other;
        block.difference[i] = a[i] - other;
    }
    return any_nonzero(a, count) || (split && any_nonzero(b, count));
}

}  // namespace

RootSum root_sum(const AdamState& state) {
    RootSum sum;
    for (const BlockRoots& b : state.roots) {
        add(b.sum, sum.sum);
        sum.count += double{b.count};
    }
    return sum;
}

void begin_step(const AdamOptions& options, std::size_t parameters, const RootSum& roots,
                AdamState& state) {
    const auto grow = [&](std::vector<float>& values) {
        reserve_pages(parameters, values);
        values.resize(parameters);
    };
    grow(state.mean), grow(state.square);
    if (options.gate) grow(state.noise);
    state.visited.resize(dirty_blocks_in(parameters), 0);
    if (options.damping > 0) {
        state.roots.resize(dirty_blocks_in(parameters));
        state.mean_root =
            roots.count > 0 ? static_cast<float>(value_of(roots.sum) / roots.count) : 0.0f;
    }
    ++state.steps;
}

void step_part(const AdamOptions& options, const GradientSpans& gradient, AdamState& state,
               std::span<float> parameters, std::size_t begin, std::size_t end) {
    const float rate = corrected_rate(options, state.steps);
    const bool gated = options.gate && !gradient.second.empty();
    const float root = options.damping * state.mean_root, damping = root * root;
    const float way_back = std::min(1.0f, rate_at(options, state.steps) * options.weight_decay);
    for (std::size_t i = begin; i < end; i += kDirtyBlock) {
        const std::size_t count = std::min(kDirtyBlock, end - i);
        char& visited = state.visited[i / kDirtyBlock];
        const bool dirty = gradient.dirty.empty() || gradient.dirty[i / kDirtyBlock];
        if (!visited && !dirty) continue;
        BlockGradient block;
        if (dirty) visited |= read_block(gradient, i, count, block);
        if (!visited) continue;
        const auto at = [&](std::vector<float>& v) { return v.empty() ? nullptr : &v[i]; };
        const StepArrays arrays{count,
                                block.sum.data(),
                                block.difference.data(),
                                at(state.mean),
                                at(state.square),
                                at(state.noise),
                                &parameters[i],
                                initial_at(state.initial, i)};
        if (way_back > 0) decay(way_back, arrays);
        (gated ? adam<true> : adam<false>)(options, rate, damping, arrays);
        if (options.damping > 0) state.roots[i / kDirtyBlock] = roots_of(arrays);
    }
}

void step(const AdamOptions& options, const GradientSpans& gradient, const RootSum& roots,
          AdamState& state, std::span<float> parameters) {
    begin_step(options, parameters.size(), roots, state);
    parallel_chunks(parameters.size(), kParallelFloats, [&](std::size_t begin, std::size_t end) {
        step_part(options, gradient, state, parameters, begin, end);
    });
}

}  // namespace burnish
