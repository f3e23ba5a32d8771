#include "burnish/inverse/optimizer.h"

#include <algorithm>
#include <cmath>

#include "burnish/core/parallel.h"

namespace burnish {

namespace {

/// Arrays of `count` parameters that do not overlap.
struct StepArrays {
    std::size_t count = 0;
    const float* gradient = nullptr;
    float* first = nullptr;
    float* second = nullptr;
    float* parameters = nullptr;
};

void adam(const OptimizerOptions& o, float rate, const StepArrays& a) {
    const float* __restrict g = a.gradient;
    float* __restrict m = a.first;
    float* __restrict v = a.second;
    float* __restrict x = a.parameters;
    const float b1 = o.beta1, b2 = o.beta2, epsilon = o.epsilon;
    for (std::size_t i = 0; i < a.count; ++i) {
        m[i] = b1 * m[i] + (1 - b1) * g[i];
        v[i] = b2 * v[i] + (1 - b2) * g[i] * g[i];
        x[i] -= rate * m[i] / (std::sqrt(v[i]) + epsilon);
    }
}

void sgd(const OptimizerOptions& o, const StepArrays& a) {
    const float* __restrict g = a.gradient;
    float* __restrict v = a.first;
    float* __restrict x = a.parameters;
    for (std::size_t i = 0; i < a.count; ++i) {
        v[i] = o.momentum * v[i] + g[i];
        x[i] -= o.learning_rate * v[i];
    }
}

/// The learning rate with Adam's correction for means that began at zero.
float corrected_rate(const OptimizerOptions& o, std::uint32_t steps) {
    const double t = steps;
    return static_cast<float>(double{o.learning_rate} *
                              std::sqrt(1 - std::pow(double{o.beta2}, t)) /
                              (1 - std::pow(double{o.beta1}, t)));
}

}  // namespace

void begin_step(const OptimizerOptions& options, std::size_t parameters, OptimizerState& state) {
    state.first.resize(parameters);
    if (options.kind == Optimizer::kAdam) state.second.resize(parameters);
    state.active.resize((parameters + kActiveChunk - 1) / kActiveChunk, 0);
    ++state.steps;
}

void step_part(const OptimizerOptions& options, std::span<const float> gradient,
               OptimizerState& state, std::span<float> parameters, std::size_t begin,
               std::size_t end) {
    const float rate =
        options.kind == Optimizer::kAdam ? corrected_rate(options, state.steps) : 0.0f;
    for (std::size_t i = begin; i < end; i += kActiveChunk) {
        const auto chunk = gradient.subspan(i, std::min(kActiveChunk, end - i));
        char& active = state.active[i / kActiveChunk];
        active = active || std::any_of(chunk.begin(), chunk.end(), [](float g) { return g != 0; });
        if (!active) continue;
        const StepArrays arrays{chunk.size(), chunk.data(), &state.first[i],
                                state.second.empty() ? nullptr : &state.second[i], &parameters[i]};
        options.kind == Optimizer::kAdam ? adam(options, rate, arrays) : sgd(options, arrays);
    }
}

void step(const OptimizerOptions& options, std::span<const float> gradient, OptimizerState& state,
          std::span<float> parameters) {
    begin_step(options, parameters.size(), state);
    parallel_chunks(parameters.size(), 16 * kActiveChunk, [&](std::size_t begin, std::size_t end) {
        step_part(options, gradient, state, parameters, begin, end);
    });
}

}  // namespace burnish
