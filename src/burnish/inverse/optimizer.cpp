#include "burnish/inverse/optimizer.h"

#include <algorithm>
#include <cmath>

#include "burnish/core/parallel.h"

namespace burnish {

namespace {

/// Calls body(i) for every parameter of the chunks that were ever moved, in parallel.
template <class Body>
void for_active(std::span<const float> g, OptimizerState& state, const Body& body) {
    const std::size_t chunks = (g.size() + kActiveChunk - 1) / kActiveChunk;
    state.active.resize(chunks, 0);
    parallel_chunks(chunks, 64, [&](std::size_t first, std::size_t last) {
        for (std::size_t chunk = first; chunk < last; ++chunk) {
            const std::size_t begin = chunk * kActiveChunk,
                              end = std::min(g.size(), begin + kActiveChunk);
            char& active = state.active[chunk];
            for (std::size_t i = begin; i < end && !active; ++i) active = g[i] != 0;
            if (!active) continue;
            for (std::size_t i = begin; i < end; ++i) body(i);
        }
    });
}

void adam(const OptimizerOptions& o, std::span<const float> g, OptimizerState& state,
          std::span<float> x) {
    const double t = state.steps;
    const auto rate =
        static_cast<float>(double{o.learning_rate} * std::sqrt(1 - std::pow(double{o.beta2}, t)) /
                           (1 - std::pow(double{o.beta1}, t)));
    for_active(g, state, [&](std::size_t i) {
        float& m = state.first[i];
        float& v = state.second[i];
        m = o.beta1 * m + (1 - o.beta1) * g[i];
        v = o.beta2 * v + (1 - o.beta2) * g[i] * g[i];
        x[i] -= rate * m / (std::sqrt(v) + o.epsilon);
    });
}

void sgd(const OptimizerOptions& o, std::span<const float> g, OptimizerState& state,
         std::span<float> x) {
    for_active(g, state, [&](std::size_t i) {
        float& v = state.first[i];
        v = o.momentum * v + g[i];
        x[i] -= o.learning_rate * v;
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
