#include "burnish/reproduce/trajectory.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace burnish {

namespace {

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

Image dense(const Theta& theta, const GradientResult& result) {
    return dense_gradient(theta, result.gradient)[0];
}

}  // namespace

Trajectory record_trajectory(const Subject& subject, const ReproduceOptions& options,
                             const SolveOptions& solve) {
    Trajectory trajectory;
    SolveState state = start_gray(subject, solve);
    std::vector<double> seconds;
    for (std::uint32_t v = 0; v <= options.iterations; ++v) {
        const double begin = now();
        PrimalPass primal = primal_pass(subject.problem, solve, state);
        seconds.push_back(now() - begin);
        trajectory.theta.push_back(state.theta);
        auto result = estimate_gradient(*subject.traced, state.theta, primal.loss.adjoint, v,
                                        solve.gradient, std::move(state.history));
        trajectory.adjoint.push_back(std::move(primal.loss.adjoint));
        if (v == options.iterations) break;
        state.history = std::move(result.history);
        take_step(solve, dense_gradient(state.theta, result.gradient), state);
        ++state.iteration;
    }
    trajectory.image_seconds = median(seconds);
    return trajectory;
}

DerivativeEstimate estimate_along(const Subject& subject, const Trajectory& trajectory,
                                  const GradientOptions& options) {
    constexpr std::size_t kTimed = 5;  // the stage's seconds are a median over so many iterations
    const std::size_t last = trajectory.theta.size() - 1;
    DerivativeEstimate estimate;
    History history;
    std::vector<double> seconds;
    // Without a history the last iteration alone counts: it is repeated for its time.
    const std::size_t first = has_history(options.estimator) ? 0 : last;
    for (std::size_t v = first; v <= last; ++v) {
        for (std::size_t k = 0; k < (first == last ? kTimed : 1); ++k) {
            const double begin = now();
            auto result =
                estimate_gradient(*subject.traced, trajectory.theta[v], trajectory.adjoint[v],
                                  static_cast<std::uint32_t>(v), options, std::move(history));
            if (v + kTimed > last) seconds.push_back(now() - begin);
            history = std::move(result.history);
            if (v == last) estimate.gradient = dense(trajectory.theta[v], result);
        }
    }
    estimate.seconds = median(seconds);
    return estimate;
}

DerivativeReference converged_derivative(const Subject& subject, const Trajectory& trajectory,
                                         std::uint32_t samples_per_pixel, std::uint32_t seed) {
    const Theta& theta = trajectory.theta.back();
    const std::size_t n = theta.textures[0].values.values.size();
    std::vector<double> half[2] = {std::vector<double>(n), std::vector<double>(n)};
    GradientOptions options;
    options.estimator = Estimator::kMc;
    options.samples_per_pixel = 4;
    options.seed = seed + 0x9e3779b9u;  // not that of any estimate
    const std::uint32_t estimates = std::max(2u, samples_per_pixel / 4);
    for (std::uint32_t k = 0; k < estimates; ++k) {
        const auto result = estimate_gradient(*subject.traced, theta, trajectory.adjoint.back(), k,
                                              options, History{});
        const auto channels = static_cast<std::size_t>(theta.textures[0].values.channels);
        for (const TexelGradient& g : result.gradient)
            for (std::size_t c = 0; c < channels; ++c)
                half[k % 2][g.key.texel * channels + c] += double{g.g[static_cast<int>(c)]};
    }
    DerivativeReference reference;
    reference.gradient = theta.textures[0].values;
    const double n0 = (estimates + 1) / 2, n1 = estimates / 2;
    double difference = 0, sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const double a = half[0][i] / n0, b = half[1][i] / n1, mean = 0.5 * (a + b);
        difference += 0.25 * (a - b) * (a - b);
        sum += mean * mean;
        reference.gradient.values[i] = static_cast<float>(mean);
    }
    // The mean's own noise is a part of the sum: what remains is the derivative.
    reference.nmse = sum > difference ? difference / (sum - difference) : INFINITY;
    return reference;
}

DerivativeError derivative_error(const Image& a, const Image& b) {
    double squared = 0, power = 0, paper = 0;
    std::size_t count = 0;
    std::vector<double> relative;
    const auto channels = static_cast<std::size_t>(b.channels);
    for (std::size_t t = 0; t < b.values.size(); t += channels) {
        double d2 = 0, b2 = 0;
        for (std::size_t c = t; c < t + channels; ++c) {
            const double reference = double{b.values[c]}, d = double{a.values[c]} - reference;
            d2 += d * d, b2 += reference * reference;
            paper += d * d / (reference * reference + 0.01);
            count += reference != 0;
        }
        squared += d2, power += b2;
        if (b2 > 0) relative.push_back(std::sqrt(d2 / b2));
    }
    return {count > 0 ? paper / static_cast<double>(count) : 0, power > 0 ? squared / power : 0,
            median(relative)};
}

}  // namespace burnish
