#include "burnish/inverse/optimizer.h"

#include <cmath>

#include "burnish/core/parallel.h"

namespace burnish {

namespace {

void adam(const OptimizerOptions& o, std::span<const float> g, OptimizerState& state,
          std::span<float> x) {
    const double t = state.steps;
    const auto rate =
        static_cast<float>(double{o.learning_rate} * std::sqrt(1 - std::pow(double{o.beta2}, t)) /
                           (1 - std::pow(double{o.beta1}, t)));
    parallel_chunks(x.size(), 65536, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            float& m = state.first[i];
            float& v = state.second[i];
            m = o.beta1 * m + (1 - o.beta1) * g[i];
            v = o.beta2 * v + (1 - o.beta2) * g[i] * g[i];
            x[i] -= rate * m / (std::sqrt(v) + o.epsilon);
        }
    });
}

void sgd(const OptimizerOptions& o, std::span<const float> g, OptimizerState& state,
         std::span<float> x) {
    parallel_chunks(x.size(), 65536, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            float& v = state.first[i];
            v = o.momentum * v + g[i];
            x[i] -= o.learning_rate * v;
        }
    });
}

}  // namespace

void step(const OptimizerOptions& options, std::span<const float> gradient, OptimizerState& state,
          std::span<float> parameters) {
    state.first.resize(parameters.size());
    if (options.kind == Optimizer::kAdam) state.second.resize(parameters.size());
    ++state.steps;
    options.kind == Optimizer::kAdam ? adam(options, gradient, state, parameters)
                                     : sgd(options, gradient, state, parameters);
}

}  // namespace burnish
