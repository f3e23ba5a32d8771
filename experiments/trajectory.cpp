#include "experiments/trajectory.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "core/random.h"
#include "core/stopwatch.h"
#include "experiments/interval.h"
#include "optimize/loss.h"

namespace burnish {

namespace {

constexpr std::size_t kTimed = 5;  // an estimate's seconds are a median over so many

void tell(const Progress& progress, std::size_t done, std::size_t all) {
    if (progress) progress(static_cast<double>(done) / static_cast<double>(all));
}

/// The passes that are drawn at once, a divisor of all.
std::uint32_t passes_at_once(const Image& adjoint, std::uint32_t passes, std::size_t max) {
    const std::size_t pixels = static_cast<std::size_t>(adjoint.width * adjoint.height);
    std::uint32_t at_once = passes;
    while (at_once > 1 && (at_once * pixels > max || passes % at_once != 0)) --at_once;
    return at_once;
}

bool keeps_state(const MonteCarlo& o) { return o.adaptive_sampling; }
bool keeps_state(const Reservoirs& o) { return o.reuse || o.adaptive_sampling; }
bool keeps_state(const PathCache&) { return true; }

void add(const Image& image, std::vector<double>& sum) {
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += double{image.values[i]};
}

/// An estimator that keeps nothing between iterations. It makes no image, for which alone work
/// memory is prepared: others have it before they are timed.
ScriptedEstimator estimator_at_end(const Estimator& estimator, std::uint32_t seed) {
    ScriptedEstimator at_end(estimator, seed);
    at_end.workspace.emplace();
    return at_end;
}

/// An estimate at the last entry, of no iteration before it.
Image estimate_at_end(const TracedScene& scene, const Trajectory& trajectory,
                      std::uint32_t iteration, ScriptedEstimator& at_end) {
    return estimate_next(scene, trajectory.theta.back(), trajectory.adjoint.back(), iteration,
                         at_end);
}

/// How many estimates with fewer passes the baseline is the mean of; leaves it those passes.
std::uint32_t split_passes(const Image& adjoint, std::size_t max_at_once, Estimator& estimator) {
    auto* mc = std::get_if<MonteCarlo>(&estimator);
    if (mc == nullptr) return 1;
    const std::uint32_t passes = mc->samples;
    mc->samples = passes_at_once(adjoint, passes, max_at_once);
    return passes / mc->samples;
}

/// An estimate that needs no other iteration, repeated for its time.
DerivativeEstimate estimate_repeatedly(const TracedScene& scene, const Trajectory& trajectory,
                                       Estimator estimator, std::uint32_t seed,
                                       std::size_t max_at_once, double enough_seconds) {
    const auto iteration = static_cast<std::uint32_t>(trajectory.theta.size() - 1);
    const std::uint32_t chunks = split_passes(trajectory.adjoint.back(), max_at_once, estimator);
    DerivativeEstimate result;
    result.gradient = trajectory.theta.back().textures[0].values;
    std::vector<double> seconds, sum(result.gradient.values.size());
    ScriptedEstimator at_end = estimator_at_end(estimator, seed);
    const Stopwatch all;
    do {
        std::fill(sum.begin(), sum.end(), 0.0);
        Stopwatch watch;
        for (std::uint32_t k = 0; k < chunks; ++k)
            add(estimate_at_end(scene, trajectory, iteration * chunks + k, at_end), sum);
        seconds.push_back(watch.lap());
    } while (seconds.size() < kTimed && all.total() < enough_seconds);
    result.seconds = median(seconds);
    for (std::size_t i = 0; i < sum.size(); ++i)
        result.gradient.values[i] = static_cast<float>(sum[i] / chunks);
    return result;
}

}  // namespace

Trajectory record_trajectory(const TargetScene& scene, const Options& options,
                             std::uint32_t iterations, const Progress& progress) {
    Trajectory trajectory;
    Solver solver(problem_of(scene), options);
    std::vector<double> seconds;
    for (std::uint32_t v = 0; v <= iterations; ++v) {
        trajectory.theta.push_back({{{scene.texture, solver.texture(0)}}});
        seconds.push_back(solver.step().image_seconds);
        trajectory.adjoint.push_back(
            evaluate_loss(options.loss, solver.image(), scene.target, {}).adjoint);
        tell(progress, v + 1, iterations + 1);
    }
    trajectory.image_seconds = median(seconds);
    return trajectory;
}

Image estimate_next(const TracedScene& scene, const Theta& theta, const Image& adjoint,
                    std::uint32_t iteration, ScriptedEstimator& along) {
    const Binding binding(scene, theta);
    if (!along.workspace)
        along.workspace = make_workspace(along.estimator, binding, reaching_pixels(binding));
    const IterationKey key{along.seed, iteration};
    if (!has_own_derivatives(along.estimator))
        estimate_image(along.estimator, binding, key, along.state, *along.workspace);
    const GradientEstimate estimate = estimate_gradient(along.estimator, binding, {&adjoint, 1},
                                                        key, along.state, *along.workspace);
    release(*along.workspace);  // no iteration is taken back
    return sum_of(estimate.gradient[0]);
}

DerivativeEstimate estimate_along(const TracedScene& scene, const Trajectory& trajectory,
                                  const Estimator& estimator, std::uint32_t seed,
                                  const Progress& progress, std::size_t max_at_once,
                                  double enough_seconds) {
    if (!std::visit([](const auto& o) { return keeps_state(o); }, estimator))
        return estimate_repeatedly(scene, trajectory, estimator, seed, max_at_once, enough_seconds);
    ScriptedEstimator along(estimator, seed);
    DerivativeEstimate estimate;
    std::vector<double> seconds;
    const std::size_t count = trajectory.theta.size();
    for (std::size_t v = 0; v < count; ++v) {
        Stopwatch watch;
        estimate.gradient = estimate_next(scene, trajectory.theta[v], trajectory.adjoint[v],
                                          static_cast<std::uint32_t>(v), along);
        if (v + kTimed >= count) seconds.push_back(watch.lap());
        tell(progress, v + 1, count);
    }
    estimate.seconds = median(seconds);
    return estimate;
}

CostLine baseline_cost(const TracedScene& scene, const Trajectory& trajectory, std::uint32_t seed) {
    const auto time = [&](std::uint32_t samples) {
        return estimate_along(scene, trajectory, baseline_estimator(samples), seed).seconds;
    };
    const double one = time(1), five = time(5);
    return {one, std::max((five - one) / 4, 1e-9)};
}

std::uint32_t affordable_samples(const CostLine& cost, double seconds, std::uint32_t max) {
    const double samples = 1 + (seconds - cost.first) / cost.each;
    return static_cast<std::uint32_t>(std::clamp(samples, 1.0, static_cast<double>(max)));
}

DerivativeReference converged_derivative(const TracedScene& scene, const Trajectory& trajectory,
                                         std::uint32_t samples_per_pixel, std::uint32_t seed,
                                         const Progress& progress) {
    DerivativeReference reference;
    reference.gradient = trajectory.theta.back().textures[0].values;
    const std::size_t n = reference.gradient.values.size();
    std::vector<double> half[2] = {std::vector<double>(n), std::vector<double>(n)};
    const MonteCarlo mc =
        baseline_estimator(passes_at_once(trajectory.adjoint.back(), 4, kMaxAtOnce));
    const std::uint32_t estimates = std::max(2u, samples_per_pixel / mc.samples);
    const std::uint32_t own_seed = seed + 0x9e3779b9u;  // not that of any estimate
    // A seed for each half: the passes of one share a sequence of film offsets that fills the
    // pixel evenly, so that they are not independent.
    ScriptedEstimator at_end[2] = {estimator_at_end(mc, seed_of_half(own_seed, 0)),
                                   estimator_at_end(mc, seed_of_half(own_seed, 1))};
    for (std::uint32_t k = 0; k < estimates; ++k) {
        add(estimate_at_end(scene, trajectory, k / 2, at_end[k % 2]), half[k % 2]);
        tell(progress, k + 1, estimates);
    }
    const double n0 = (estimates + 1) / 2, n1 = estimates / 2;
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const double a = half[0][i] / n0, b = half[1][i] / n1, mean = 0.5 * (a + b);
        reference.squared_error += 0.25 * (a - b) * (a - b);
        sum += mean * mean;
        reference.gradient.values[i] = static_cast<float>(mean);
    }
    // The mean's own noise is a part of the sum: what remains is the derivative.
    const double noise = reference.squared_error;
    reference.nmse = sum > noise ? noise / (sum - noise) : INFINITY;
    return reference;
}

double normalized_error(double squared, double power, double s) {
    return positive_ratio(squared - s, power - s);
}

DerivativeError derivative_error(const Image& a, const DerivativeReference& reference) {
    const Image& b = reference.gradient;
    double squared = 0, power = 0, paper = 0;
    std::size_t count = 0;
    std::vector<double> relative;
    const auto channels = static_cast<std::size_t>(b.channels);
    for (std::size_t t = 0; t < b.values.size(); t += channels) {
        double d2 = 0, b2 = 0;
        for (std::size_t c = t; c < t + channels; ++c) {
            const double value = double{b.values[c]}, d = double{a.values[c]} - value;
            d2 += d * d, b2 += value * value;
            paper += d * d / (value * value + 0.01);
            count += value != 0;
        }
        squared += d2, power += b2;
        if (b2 > 0) relative.push_back(std::sqrt(d2 / b2));
    }
    return {count > 0 ? paper / static_cast<double>(count) : 0,
            normalized_error(squared, power, reference.squared_error), median(relative)};
}

}  // namespace burnish
