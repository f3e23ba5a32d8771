#include "experiments/closed_loop.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "optimize/iterate.h"

namespace burnish {

namespace {

/// The gradient of the next iteration from a state.
Image next_gradient(const Setup& setup, State::Values state) {
    Workspace workspace = make_workspace(setup, state);
    iterate(setup, state, workspace);
    const EstimatorWorkspace& own = workspace.views[0].estimator;
    return sum_of(has_split_gradient(setup.options.estimator) ? own.cache.gradient[0].gradient[0]
                                                              : own.gradient[0]);
}

/// The gradient at `texture` from fresh passes alone, so many in each half.
Image fresh_gradient(Problem problem, Options options, const Image& texture, std::uint32_t passes,
                     std::uint32_t seed) {
    options.estimator = PathCache{.samples = 2 * passes, .window = passes};
    options.parameterization = Parameterization::kTexels;  // starts at `texture` to the byte
    options.seed = seed;
    problem.unknowns[0].start = texture;
    const Setup setup = make_setup(problem, options);
    return next_gradient(setup, make_state(setup));
}

}  // namespace

std::uint32_t reference_passes(const Options& options, std::uint32_t iterations) {
    const auto* cache = std::get_if<PathCache>(&options.estimator);
    if (!cache || options.loss != Loss::kReweighted) return 16;
    const std::uint64_t traced = std::uint64_t{iterations} * cache->samples;
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(traced / 2, 1, cache->window));
}

LoopProducts run_closed_loop(const Problem& problem, Options options, std::uint32_t iterations,
                             std::uint32_t run) {
    options.seed = 3 * run;
    Solver solver(problem, options);
    while (solver.iterations() + 1 < iterations) solver.step();
    const Image g = next_gradient(make_setup(problem, options), solver.state().values());
    const std::uint32_t passes = reference_passes(options, iterations);
    const Image a = fresh_gradient(problem, options, solver.texture(0), passes, 3 * run + 1),
                b = fresh_gradient(problem, options, solver.texture(0), passes, 3 * run + 2);
    const double norm = dot(a, b);
    return {dot(g, b) - norm, norm};
}

LoopBias bias_of(std::span<const LoopProducts> runs) {
    double error = 0, norm = 0;
    for (const LoopProducts& p : runs) error += p.error, norm += p.norm;
    const double bias = error / norm;
    const double n = static_cast<double>(runs.size());
    double squares = 0;  // of a ratio of means, to first order
    for (const LoopProducts& p : runs) squares += std::pow(p.error - bias * p.norm, 2);
    return {bias, std::sqrt(squares * n / (n - 1)) / std::abs(norm)};
}

}  // namespace burnish
