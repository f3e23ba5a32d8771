// Means of gradients over independent runs along a script: all numbers of a gradient and random
// projections of them, per iteration, and the comparison of two such sets.
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

/// Tampers with what an estimator keeps, before iteration v reads it.
using Tamper = std::function<void(ReservoirsState& state, std::size_t v)>;

inline void leave_alone(ReservoirsState&, std::size_t) {}

/// The numbers of one run's estimates along a script: [iteration][number].
inline std::vector<std::vector<double>> run_along(const TracedScene& traced,
                                                  const ScriptSpans& script,
                                                  const Estimator& estimator, std::uint32_t seed,
                                                  const Tamper& tamper = leave_alone) {
    std::vector<std::vector<double>> numbers;
    EstimatorState state = make_state(estimator);
    for (std::size_t v = 0; v < script.theta.size(); ++v) {
        if (auto* reservoirs = std::get_if<ReservoirsState>(&state)) tamper(*reservoirs, v);
        const GradientResult result =
            estimate(estimator, Binding(traced, script.theta[v]), script.adjoint[v],
                     {seed, static_cast<std::uint32_t>(v)}, state);
        numbers.push_back(numbers_of(script.theta[v], result.gradient));
    }
    return numbers;
}

/// [run][iteration][number]
using Runs = std::vector<std::vector<std::vector<double>>>;
/// [iteration][number]
using Estimates = std::vector<std::vector<RunningMean>>;

/// Adds up runs in order, so that the result does not depend on threads.
inline Estimates sum_runs(const Runs& runs) {
    Estimates estimates(runs[0].size());
    for (const auto& run : runs)
        for (std::size_t v = 0; v < run.size(); ++v) {
            estimates[v].resize(run[v].size());
            for (std::size_t i = 0; i < run[v].size(); ++i) estimates[v][i].add(run[v][i]);
        }
    return estimates;
}

/// p-value of "both have the same expectation, in every number of every iteration".
inline double agreement_p_value(const Estimates& a, const Estimates& b) {
    std::vector<double> p;
    for (std::size_t v = 0; v < a.size(); ++v)
        for (std::size_t i = 0; i < a[v].size(); ++i)
            p.push_back(welch_p_value(estimate_of(a[v][i]), estimate_of(b[v][i])));
    return holm_minimum(p);
}

}  // namespace burnish::test
