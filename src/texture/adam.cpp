#include "texture/adam.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"

namespace burnish {

namespace {

/// Arrays of `count` parameters that do not overlap.
struct StepArrays {
    std::size_t count = 0;
    const float* gradient = nullptr;
    const float* difference = nullptr;  ///< of the gradient's halves
    float* first = nullptr;
    float* second = nullptr;
    float* noise = nullptr;
    float* parameters = nullptr;
    const float* home = nullptr;  ///< null: zero
};

/// Of plain Adam neither the difference nor the noise is read.
template <bool kByAgreement>
void adam(const OptimizerOptions& o, float rate, const StepArrays& a) {
    const float* __restrict g = a.gradient;
    const float* __restrict d = a.difference;
    float* __restrict m = a.first;
    float* __restrict v = a.second;
    float* __restrict n = a.noise;
    float* __restrict x = a.parameters;
    const float b1 = o.beta1, b2 = o.beta2, epsilon = o.epsilon;
    for (std::size_t i = 0; i < a.count; ++i) {
        m[i] = b1 * m[i] + (1 - b1) * g[i];
        v[i] = b2 * v[i] + (1 - b2) * g[i] * g[i];
        float step = rate;
        if constexpr (kByAgreement) {
            n[i] = b2 * n[i] + (1 - b2) * d[i] * d[i];
            step *= snr_gate(v[i], n[i]);
        }
        x[i] -= step * m[i] / (std::sqrt(v[i]) + epsilon);
    }
}

float sum_of(std::array<float, kDirtyBlock> values) {
    static_assert(kDirtyBlock == 48);
    for (std::size_t n = kDirtyBlock / 2; n >= 3; n /= 2)
        for (std::size_t i = 0; i < n; ++i) values[i] += values[i + n];
    return values[0] + values[1] + values[2];
}

BlockGate gates_of(const StepArrays& a) {
    std::array<float, kDirtyBlock> sum{}, count{};
    for (std::size_t i = 0; i < a.count; ++i) {
        sum[i] = snr_gate(a.second[i], a.noise[i]);
        count[i] = a.second[i] > 0 ? 1.0f : 0.0f;
    }
    return {sum_of(sum), sum_of(count)};
}

/// 1 where nothing is known.
float mean_of(const std::vector<BlockGate>& gates) {
    double sum = 0, count = 0;
    for (const BlockGate& a : gates) {
        sum += double{a.sum};
        count += double{a.count};
    }
    return count > 0 ? static_cast<float>(sum / count) : 1.0f;
}

/// share: of the way home.
void draw_home(float share, const StepArrays& a) {
    static constexpr std::array<float, kDirtyBlock> kZeros{};
    float* __restrict x = a.parameters;
    const float* __restrict home = a.home ? a.home : kZeros.data();
    for (std::size_t i = 0; i < a.count; ++i) x[i] -= share * (x[i] - home[i]);
}

void sgd(const OptimizerOptions& o, float rate, const StepArrays& a) {
    const float* __restrict g = a.gradient;
    float* __restrict v = a.first;
    float* __restrict x = a.parameters;
    for (std::size_t i = 0; i < a.count; ++i) {
        v[i] = o.momentum * v[i] + g[i];
        x[i] -= rate * v[i];
    }
}

/// The learning rate with Adam's correction for means that began at zero.
float corrected_rate(const OptimizerOptions& o, std::uint32_t steps) {
    const double t = steps;
    return static_cast<float>(double{rate_at(o, steps)} *
                              std::sqrt(1 - std::pow(double{o.beta2}, t)) /
                              (1 - std::pow(double{o.beta1}, t)));
}

bool has_snr_prior(const OptimizerOptions& o) {
    return o.kind == Optimizer::kGatedAdam && o.snr_prior > 0;
}

/// Of the segment that begins at i; null: zero.
const float* home_at(const std::vector<float>& home, std::size_t i) {
    if (home.empty()) return nullptr;
    return home.size() == kDirtyBlock ? home.data() : &home[i];
}

/// The sum and the difference of a segment's halves.
struct BlockGradient {
    std::array<float, kDirtyBlock> sum{}, difference{};
};

/// Whether any of it is other than zero.
bool read_block(const GradientSpans& gradient, std::size_t begin, std::size_t count,
                  BlockGradient& segment) {
    const float* __restrict a = gradient.first.data() + begin;
    const bool split = !gradient.second.empty();
    const float* __restrict b = split ? gradient.second.data() + begin : nullptr;
    for (std::size_t i = 0; i < count; ++i) {
        const float other = split ? b[i] : 0.0f;
        segment.sum[i] = a[i] + other;
        segment.difference[i] = a[i] - other;
    }
    return any_nonzero(a, count) || (split && any_nonzero(b, count));
}

}  // namespace

void begin_step(const OptimizerOptions& options, std::size_t parameters, OptimizerState& state) {
    state.first.resize(parameters);
    if (options.kind != Optimizer::kSgd) state.second.resize(parameters);
    if (options.kind == Optimizer::kGatedAdam) state.noise.resize(parameters);
    state.active.resize(dirty_blocks_in(parameters), 0);
    if (has_snr_prior(options)) {
        state.gates.resize(dirty_blocks_in(parameters));
        state.mean_gate = mean_of(state.gates);
    }
    ++state.steps;
}

void step_part(const OptimizerOptions& options, const GradientSpans& gradient,
               OptimizerState& state, std::span<float> parameters, std::size_t begin,
               std::size_t end) {
    const float rate = options.kind == Optimizer::kSgd ? rate_at(options, state.steps)
                                                       : corrected_rate(options, state.steps);
    const bool weighs = has_snr_prior(options);
    const float evidence =
        weighs ? std::min(1.0f, state.mean_gate / options.snr_prior) : 1.0f;
    const float way_home =
        options.kind == Optimizer::kSgd ? 0 : rate_at(options, state.steps) * options.decay;
    for (std::size_t i = begin; i < end; i += kDirtyBlock) {
        const std::size_t count = std::min(kDirtyBlock, end - i);
        char& active = state.active[i / kDirtyBlock];
        const bool reached = gradient.reached.empty() || gradient.reached[i / kDirtyBlock];
        if (!active && !reached) continue;
        BlockGradient segment;
        if (reached) active |= read_block(gradient, i, count, segment);
        if (!active) continue;
        const auto at = [&](std::vector<float>& v) { return v.empty() ? nullptr : &v[i]; };
        const StepArrays arrays{count,           segment.sum.data(),    segment.difference.data(),
                                at(state.first), at(state.second),      at(state.noise),
                                &parameters[i],  home_at(state.home, i)};
        if (way_home > 0) draw_home(std::min(1.0f, way_home), arrays);
        if (options.kind == Optimizer::kSgd) {
            sgd(options, rate, arrays);
        } else if (options.kind == Optimizer::kGatedAdam && !gradient.second.empty()) {
            adam<true>(options, rate * evidence, arrays);
            if (weighs) state.gates[i / kDirtyBlock] = gates_of(arrays);
        } else {
            adam<false>(options, rate, arrays);
        }
    }
}

void step(const OptimizerOptions& options, const GradientSpans& gradient, OptimizerState& state,
          std::span<float> parameters) {
    begin_step(options, parameters.size(), state);
    parallel_chunks(parameters.size(), kParallelFloats, [&](std::size_t begin, std::size_t end) {
        step_part(options, gradient, state, parameters, begin, end);
    });
}

}  // namespace burnish
