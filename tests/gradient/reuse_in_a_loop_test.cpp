// Reuse in a closed loop and along a script. In an optimisation run the samples of the history have
// moved the texture under which they are reused, so that the estimate is not independent of the
// texture, and E[estimate - gradient at that texture] need not vanish: the adaptivity bias. Along a
// script, here the textures and adjoints of a run that other samples made, it must.
//
// The bias is measured along the gradient: where an estimate is too large the texture moves too
// far, to where the gradient is smaller, and the same sample is used again.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/parallel.h"
#include "gradient/gradient_runs.h"
#include "gradient/small_scene.h"
#include "ledger_entries.h"
#include "optimize/loss.h"
#include "render/render.h"
#include "texture/adam.h"

namespace burnish {
namespace {

using namespace test::ledger;
using test::accepted;
using test::Estimates;
using test::numbers_of;
using test::rejected;
using test::Runs;
using test::scaled;
using test::seed_of;

constexpr std::uint32_t kLoopIterations = 10;

Reservoirs with_reuse() {
    Reservoirs options = test::by_integrand(test::pgris());
    options.confidence_cap = 64;
    return options;
}

Image image_at(const TracedScene& traced, const Theta& theta, std::uint32_t seed,
               std::uint32_t iteration, std::uint32_t passes) {
    const TextureTable textures = texture_table(*traced.scene, theta);
    const TraceInput input{&traced, &textures,           {seed, Stream::kImage},
                           passes,  SurfaceChoice::kAll, {}};
    return render(input, iteration, passes);
}

/// What the samples of an optimisation run made of the problem, and what they estimated.
struct OptimizationRun {
    std::vector<Theta> theta;
    std::vector<Image> adjoint;
    std::vector<std::vector<double>> estimates;  ///< [iteration][number]
};

/// Adam from `start` towards the target image.
OptimizationRun optimize_with_reuse(const TracedScene& traced, const Theta& start,
                                    const Image& target, float learning_rate, std::uint32_t seed) {
    OptimizationRun optimization;
    const AdamOptions adam{.learning_rate = learning_rate};
    std::vector<AdamState> adam_states(start.textures.size());
    Theta theta = start;
    ReservoirsState state;
    for (std::uint32_t v = 0; v < kLoopIterations; ++v) {
        const Image image = image_at(traced, theta, seed, v, 4);
        optimization.theta.push_back(theta);
        optimization.adjoint.push_back(evaluate_loss(Loss::kRelMse, image, target, {}).adjoint);
        const GradientResult result = estimate_gradient(
            with_reuse(), Binding(traced, theta), optimization.adjoint.back(), seed, v, state);
        optimization.estimates.push_back(numbers_of(theta, result.gradient));
        const std::vector<Image> gradient = dense_gradient(theta, result.gradient);
        for (std::size_t t = 0; t < gradient.size(); ++t) {
            std::vector<float>& texels = theta.textures[t].values.values;
            step(adam, {gradient[t].values, {}}, root_sum(adam_states[t]), adam_states[t], texels);
            for (float& x : texels) x = std::clamp(x, 0.0f, 1.0f);
        }
    }
    return optimization;
}

std::vector<std::vector<double>> difference(std::vector<std::vector<double>> a,
                                            const std::vector<std::vector<double>>& b) {
    for (std::size_t v = 0; v < a.size(); ++v)
        for (std::size_t i = 0; i < a[v].size(); ++i) a[v][i] -= b[v][i];
    return a;
}

/// Estimates less the baseline's at the same textures; and the mean of the baseline, from runs of
/// its own.
struct Loops {
    Runs closed, open;
    Estimates gradient;
};

Loops run_loops(float learning_rate, std::size_t count) {
    const Scene scene = test::make_small_scene();
    const TracedScene traced = prepare(scene);
    const Theta truth = test::theta_of(scene);
    Theta start = truth;
    for (ThetaTexture& t : start.textures)
        std::fill(t.values.values.begin(), t.values.values.end(), 0.5f);
    const Image target = image_at(traced, truth, 43, 0, 1024);
    const std::size_t for_direction = count / 8;
    Runs closed(count), open(count), gradient(count);
    parallel_for(count, [&](std::size_t run) {
        const auto seed = [&](std::uint32_t set) {
            return seed_of(kReuseInALoop, 100000 * set + static_cast<std::uint32_t>(run));
        };
        const OptimizationRun loop =
            optimize_with_reuse(traced, start, target, learning_rate, seed(0));
        const test::ScriptSpans script{loop.theta, loop.adjoint};
        gradient[run] = test::run_along(traced, script, test::mc(4), seed(1));
        if (run < for_direction) return;
        open[run] =
            difference(test::run_along(traced, script, with_reuse(), seed(2)), gradient[run]);
        closed[run] = difference(loop.estimates, gradient[run]);
    });
    const auto later = [&](const Runs& runs) {
        return Runs(runs.begin() + for_direction, runs.end());
    };
    return {later(closed), later(open),
            test::sum_runs(Runs(gradient.begin(), gradient.begin() + for_direction))};
}

/// Per run, how far the estimates of an iteration lie from the gradient along the gradient's mean,
/// relative to it: -0.1 where they are 10 % too small. The last entry: over all iterations at once.
std::vector<test::RunningMean> relative_errors(const Runs& differences, const Estimates& gradient) {
    std::vector<test::RunningMean> errors(kLoopIterations + 1);
    for (const auto& run : differences) {
        double all = 0, norm = 0;
        for (std::size_t v = 0; v < kLoopIterations; ++v) {
            double along = 0, square = 0;
            for (std::size_t i = 0; i + test::kProjections < run[v].size(); ++i) {
                const double direction = gradient.numbers[v][i].mean;
                along += run[v][i] * direction, square += direction * direction;
            }
            errors[v].add(along / square);
            all += along, norm += square;
        }
        errors[kLoopIterations].add(all / norm);
    }
    return errors;
}

/// p-value of "the mean difference is nothing, in every number and along the gradient".
double vanishing_p_value(const Runs& differences, const Estimates& gradient) {
    std::vector<double> numbers, along;
    const auto p_of = [](const test::RunningMean& m) {
        return test::welch_p_value(test::estimate_of(m), {0, 0});
    };
    for (const auto& iteration : test::sum_runs(differences).numbers)
        for (const test::RunningMean& m : iteration) numbers.push_back(p_of(m));
    for (const test::RunningMean& m : relative_errors(differences, gradient))
        along.push_back(p_of(m));
    return test::holm_minimum({test::holm_minimum(numbers), test::holm_minimum(along)});
}

std::string text_of(const std::vector<test::RunningMean>& errors) {
    std::string text;
    for (const test::RunningMean& m : errors)
        text += fmt::format(" {:+.3f}+-{:.3f}", m.mean, m.standard_error());
    return text;
}

struct Rate {
    float learning_rate;
    std::size_t runs;
};
constexpr Rate kSlow{0.01f, 688}, kFast{0.05f, 2744};

Loops measure(const Rate& rate) {
    Loops loops = run_loops(rate.learning_rate, scaled(kReuseInALoop, rate.runs));
    fmt::print(
        "learning rate {}: relative error along the gradient, by iteration and over all\n"
        "  closed loop {}\n  script      {}\n",
        rate.learning_rate, text_of(relative_errors(loops.closed, loops.gradient)),
        text_of(relative_errors(loops.open, loops.gradient)));
    return loops;
}

TEST(ReuseInALoop, IsBiasedAndAlongAScriptIsNot) {
    const Loops slow = measure(kSlow), fast = measure(kFast);
    EXPECT_TRUE(
        accepted(kReuseInALoop, "script, slow", vanishing_p_value(slow.open, slow.gradient)));
    EXPECT_TRUE(
        accepted(kReuseInALoop, "script, fast", vanishing_p_value(fast.open, fast.gradient)));
    EXPECT_TRUE(rejected(kReuseInALoop, "textures moved by the reused samples",
                         vanishing_p_value(fast.closed, fast.gradient)));
}

}  // namespace
}  // namespace burnish
