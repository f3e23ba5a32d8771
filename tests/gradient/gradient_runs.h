// Means of gradients over independent runs along a script: all numbers of a gradient, random
// projections of them and the projection on the gradient itself, per iteration, and the comparison
// of two such sets. Single numbers see what goes wrong in few texels, the projection on the
// gradient sees what makes all of it a little too large or too small.
#pragma once

#include <functional>

#include "gradient/estimators.h"
#include "random_source.h"
#include "student.h"

namespace burnish::test {

inline constexpr std::size_t kProjections = 8;

/// All numbers of a gradient, and its random projections.
inline std::vector<double> numbers_of(const Theta& theta,
                                      const std::vector<TexelGradient>& gradient) {
    std::vector<double> numbers;
    for (const Image& image : dense_gradient(theta, gradient))
        for (const float g : image.values) numbers.push_back(double{g});
    const std::size_t count = numbers.size();
    RandomSource random{84};
    for (std::size_t k = 0; k < kProjections; ++k) {
        double sum = 0;
        for (std::size_t i = 0; i < count; ++i) sum += double{random.next(-1, 1)} * numbers[i];
        numbers.push_back(sum);
    }
    return numbers;
}

/// What happens to the estimators from outside, whatever their estimates are: one of each in an
/// iteration.
struct ScriptSpans {
    std::span<const Theta> theta;
    std::span<const Image> adjoint;
};

/// Tampers with what reservoirs keep, before iteration v reads it; empty: does not.
using Tamper = std::function<void(ReservoirsState& state, std::size_t v)>;

/// The other vertices of kept paths scatter twice.
inline void scatter_twice(ReservoirsState& state, std::size_t) {
    PathVertices twice;
    for (std::size_t i = 0; i < state.history.others.ends.size(); ++i) {
        const auto own = vertices_of(state.history.others, i);
        std::vector<PathVertex> both(own.begin(), own.end());
        both.insert(both.end(), own.begin(), own.end());
        append(twice, both);
    }
    state.history.others = twice;
}

/// The numbers of one run's estimates along a script: [iteration][number].
inline std::vector<std::vector<double>> run_along(const TracedScene& traced,
                                                  const ScriptSpans& script,
                                                  const Estimator& estimator, std::uint32_t seed,
                                                  const Tamper& tamper = {}) {
    std::vector<std::vector<double>> numbers;
    EstimatorState state = make_state(estimator);
    for (std::size_t v = 0; v < script.theta.size(); ++v) {
        if (tamper) tamper(std::get<ReservoirsState>(state), v);
        const GradientResult result =
            estimate(estimator, Binding(traced, script.theta[v]), script.adjoint[v],
                     {seed, static_cast<std::uint32_t>(v)}, state);
        numbers.push_back(numbers_of(script.theta[v], result.gradient));
    }
    return numbers;
}

/// [run][iteration][number]
using Runs = std::vector<std::vector<std::vector<double>>>;
/// [iteration][number]: about the gradient, from runs that are not compared with any.
using Direction = std::vector<std::vector<double>>;

inline Direction direction_of(const Runs& runs) {
    Direction direction(runs[0].size());
    for (std::size_t v = 0; v < direction.size(); ++v) {
        direction[v].resize(runs[0][v].size() - kProjections);
        for (const auto& run : runs)
            for (std::size_t i = 0; i < direction[v].size(); ++i) direction[v][i] += run[v][i];
    }
    return direction;
}

struct Estimates {
    std::vector<std::vector<RunningMean>> numbers;  ///< [iteration][number]
    std::vector<RunningMean> along;  ///< [iteration]: on the direction; empty without one
};

/// Adds up runs in order, so that the result does not depend on threads.
inline Estimates sum_runs(const Runs& runs, const Direction& direction = {}) {
    Estimates estimates{std::vector<std::vector<RunningMean>>(runs[0].size()),
                        std::vector<RunningMean>(direction.size())};
    for (const auto& run : runs)
        for (std::size_t v = 0; v < run.size(); ++v) {
            std::vector<RunningMean>& numbers = estimates.numbers[v];
            numbers.resize(run[v].size());
            for (std::size_t i = 0; i < run[v].size(); ++i) numbers[i].add(run[v][i]);
            if (direction.empty()) continue;
            double product = 0;
            for (std::size_t i = 0; i < direction[v].size(); ++i)
                product += direction[v][i] * run[v][i];
            estimates.along[v].add(product);
        }
    return estimates;
}

/// What multiplies every number of every estimate: a seeded defect.
inline Estimates larger_by(double factor, Estimates estimates) {
    for (auto& iteration : estimates.numbers)
        for (RunningMean& m : iteration) m = larger_by(factor, m);
    for (RunningMean& m : estimates.along) m = larger_by(factor, m);
    return estimates;
}

/// p-value of "both have the same expectation, in every number of every iteration, and along the
/// gradient": half of alpha is for the numbers, half for the projections on the gradient.
inline double agreement_p_value(const Estimates& a, const Estimates& b) {
    const auto p_of = [](const RunningMean& x, const RunningMean& y) {
        return welch_p_value(estimate_of(x), estimate_of(y));
    };
    std::vector<double> numbers, along;
    for (std::size_t v = 0; v < a.numbers.size(); ++v)
        for (std::size_t i = 0; i < a.numbers[v].size(); ++i)
            numbers.push_back(p_of(a.numbers[v][i], b.numbers[v][i]));
    for (std::size_t v = 0; v < a.along.size(); ++v) along.push_back(p_of(a.along[v], b.along[v]));
    if (along.empty()) return holm_minimum(numbers);
    return holm_minimum({holm_minimum(numbers), holm_minimum(along)});
}

}  // namespace burnish::test
