#include "experiments/trajectory.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "core/stopwatch.h"
#include "gradient/path_cache/iteration.h"

namespace burnish {

namespace {

void tell(const Progress& progress, std::size_t done, std::size_t all) {
    if (progress) progress(static_cast<double>(done) / static_cast<double>(all));
}

Image dense(const Theta& theta, const GradientResult& result) {
    return dense_gradient(theta, result.gradient)[0];
}

/// The passes that are drawn at once, a divisor of all.
std::uint32_t passes_at_once(const Image& adjoint, std::uint32_t passes, std::size_t most) {
    const std::size_t pixels = static_cast<std::size_t>(adjoint.width * adjoint.height);
    std::uint32_t at_once = passes;
    while (at_once > 1 && (at_once * pixels > most || passes % at_once != 0)) --at_once;
    return at_once;
}

constexpr std::size_t kTimed = 5;  // the stage's seconds are a median over so many estimates

/// An estimate without history at the last entry, repeated for its time. The memory of the baseline
/// does not grow with its samples: the estimates of chunks of passes are averaged.
DerivativeEstimate estimate_at_end(const TracedScene& scene, const Trajectory& trajectory,
                                   GradientOptions options, std::size_t max_at_once) {
    constexpr double kEnoughSeconds = 5;
    const Theta& theta = trajectory.theta.back();
    const Image& adjoint = trajectory.adjoint.back();
    const auto iteration = static_cast<std::uint32_t>(trajectory.theta.size() - 1);
    const std::uint32_t passes = options.samples_per_pixel;
    if (options.estimator == Estimator::kMc)
        options.samples_per_pixel = passes_at_once(adjoint, passes, max_at_once);
    const std::uint32_t chunks = passes / options.samples_per_pixel;
    const auto estimate = [&](std::uint32_t k) {
        return estimate_gradient(scene, theta, adjoint, iteration * chunks + k, options, {});
    };
    const int channels = theta.textures[0].values.channels;
    DerivativeEstimate result;
    std::vector<double> seconds, sum(theta.textures[0].values.values.size());
    const Stopwatch all;
    while (seconds.size() < kTimed && all.total() < kEnoughSeconds) {
        std::fill(sum.begin(), sum.end(), 0.0);
        Stopwatch watch;
        for (std::uint32_t k = 0; k + 1 < chunks; ++k)
            accumulate(estimate(k).gradient, channels, sum);
        const GradientResult last = estimate(chunks - 1);
        seconds.push_back(watch.lap());
        accumulate(last.gradient, channels, sum);
    }
    result.seconds = median(seconds);
    result.gradient = theta.textures[0].values;
    for (std::size_t i = 0; i < sum.size(); ++i)
        result.gradient.values[i] = static_cast<float>(sum[i] / chunks);
    return result;
}

}  // namespace

Trajectory record_trajectory(const Subject& subject, const ReproduceOptions& options,
                             const SolveOptions& solve, const Progress& progress) {
    Trajectory trajectory;
    SolveState state = start_gray(subject, solve);
    std::vector<double> seconds;
    for (std::uint32_t v = 0; v <= options.iterations; ++v) {
        Stopwatch watch;
        PrimalPass primal = primal_pass(subject.problem, solve, state);
        seconds.push_back(watch.lap());
        trajectory.theta.push_back(state.theta);
        auto result = estimate_gradient(*subject.traced, state.theta, primal.loss.adjoint, v,
                                        solve.gradient, std::move(state.history));
        trajectory.adjoint.push_back(std::move(primal.loss.adjoint));
        tell(progress, v + 1, options.iterations + 1);
        if (v == options.iterations) break;
        state.history = std::move(result.history);
        take_step(solve, unsplit(dense_gradient(state.theta, result.gradient)), state);
        ++state.iteration;
    }
    trajectory.image_seconds = median(seconds);
    return trajectory;
}

DerivativeEstimate estimate_along(const TracedScene& scene, const Trajectory& trajectory,
                                  const GradientOptions& options, const Progress& progress,
                                  std::size_t max_at_once) {
    if (!has_state(options)) return estimate_at_end(scene, trajectory, options, max_at_once);
    const std::size_t last = trajectory.theta.size() - 1;
    DerivativeEstimate estimate;
    History history;
    std::vector<double> seconds;
    for (std::size_t v = 0; v <= last; ++v) {
        Stopwatch watch;
        auto result = estimate_gradient(scene, trajectory.theta[v], trajectory.adjoint[v],
                                        static_cast<std::uint32_t>(v), options, std::move(history));
        if (v + kTimed > last) seconds.push_back(watch.lap());
        history = std::move(result.history);
        if (v == last) estimate.gradient = dense(trajectory.theta[v], result);
        tell(progress, v + 1, last + 1);
    }
    estimate.seconds = median(seconds);
    return estimate;
}

DerivativeEstimate estimate_pool_along(const TracedScene& scene, const Trajectory& trajectory,
                                       const PoolOptions& options, std::uint32_t seed,
                                       const Progress& progress) {
    const std::size_t last = trajectory.theta.size() - 1;
    Pool pool = make_pool(*scene.scene, trajectory.theta[0]);
    DerivativeEstimate estimate;
    std::vector<double> seconds;
    for (std::size_t v = 0; v <= last; ++v) {
        const PoolInput input{&scene, &trajectory.theta[v], seed, options.sequence};
        Stopwatch watch;
        trace_fresh(input, options.samples_per_pixel, pool);
        keep_window(pool, options.window);
        if (v + kTimed > last) {
            pool_images(input, pool);
            const std::array<Image, 2> adjoints{trajectory.adjoint[v], trajectory.adjoint[v]};
            estimate.gradient = sum_of(pool_gradient(input, pool, adjoints)[0]);
            seconds.push_back(watch.lap());
        }
        tell(progress, v + 1, last + 1);
    }
    estimate.seconds = median(seconds);
    return estimate;
}

CostLine baseline_cost(const Subject& subject, const Trajectory& trajectory,
                       GradientOptions options) {
    options.estimator = Estimator::kMc;
    const auto time = [&](std::uint32_t samples) {
        options.samples_per_pixel = samples;
        return estimate_along(*subject.traced, trajectory, options).seconds;
    };
    const double one = time(1), five = time(5);
    return {one, std::max((five - one) / 4, 1e-9)};
}

std::uint32_t affordable_samples(const CostLine& cost, double seconds, std::uint32_t most) {
    const double samples = 1 + (seconds - cost.first) / cost.each;
    return static_cast<std::uint32_t>(std::clamp(samples, 1.0, static_cast<double>(most)));
}

DerivativeReference converged_derivative(const Subject& subject, const Trajectory& trajectory,
                                         std::uint32_t samples_per_pixel, std::uint32_t seed,
                                         const Progress& progress) {
    const Theta& theta = trajectory.theta.back();
    const std::size_t n = theta.textures[0].values.values.size();
    std::vector<double> half[2] = {std::vector<double>(n), std::vector<double>(n)};
    GradientOptions options;
    options.estimator = Estimator::kMc;
    options.samples_per_pixel = passes_at_once(trajectory.adjoint.back(), 4, kMaxAtOnce);
    options.seed = seed + 0x9e3779b9u;  // not that of any estimate
    const std::uint32_t estimates = std::max(2u, samples_per_pixel / options.samples_per_pixel);
    for (std::uint32_t k = 0; k < estimates; ++k) {
        const auto result = estimate_gradient(*subject.traced, theta, trajectory.adjoint.back(), k,
                                              options, History{});
        accumulate(result.gradient, theta.textures[0].values.channels, half[k % 2]);
        tell(progress, k + 1, estimates);
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
