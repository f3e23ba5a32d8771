// Whole iterations of the Solver against the reference: image, loss, candidates, reuse and step,
// with the same random numbers. The scene shows nothing but unknowns, for the Solver gathers the
// rest of the image on a schedule of its own.
#include <gtest/gtest.h>

#include "optimize/small_problem.h"
#include "reference/compare.h"
#include "worst.h"

namespace burnish {
namespace {

constexpr std::uint32_t kSeed = 6500, kIterations = 3;

struct PairOfRuns {
    Problem fast;
    Options options;
    reference::Problem slow;
    float learning_rate = 0.01f;  ///< of the slow one
};

PairOfRuns make_runs(Shift shift) {
    Scene scene = test::make_small_scene({.filter = FilterKind::kTent, .filter_radius = 1});
    scene.hide_emitters = true;
    Problem problem = test::problem_of(scene);
    for (Unknown& u : problem.unknowns) u.learning_rate = 0.01;
    Reservoirs reservoirs;
    reservoirs.image_samples = 8, reservoirs.samples = 2, reservoirs.adaptive_sampling = false;
    reservoirs.shift = shift, reservoirs.confidence_cap = 3;
    Options options;
    options.estimator = reservoirs;
    options.loss = Loss::kRelMse;
    options.parameterization = Parameterization::kTexels;
    options.seed = kSeed;
    const Image target = problem.views[0].image;
    const TracedScene& traced = problem.renderer.data().traced;
    return {problem,
            options,
            {traced,
             target,
             {{kSeed, Stream::kImage}, 8},
             {{kSeed, Stream::kDerivative}, 2},
             shift,
             3}};
}

/// The textures, and Adam's means of gradients and squares.
struct SlowState {
    Theta pi;
    reference::Gradient mean, square;
    reference::History history;
};

/// A step of Adam [Kingma and Ba 2015] after iteration v, and pi back into [0, 1].
void step(reference::Gradient gradient, std::uint32_t v, float learning_rate, SlowState& state) {
    const float b1 = 0.9f, b2 = 0.999f, t = static_cast<float>(v + 1);
    const float rate = learning_rate * std::sqrt(1 - std::pow(b2, t)) / (1 - std::pow(b1, t));
    for (const auto& [i, g] : gradient) state.mean[i];  // all that ever had a gradient
    for (auto& [i, m] : state.mean) {
        const Rgbf g = gradient[i];
        Rgbf& n = state.square[i];
        m = m * b1 + g * (1 - b1), n = n * b2 + g * g * (1 - b2);
        Image& texels = state.pi.textures[i.texture].values;
        for (int c = 0; c < texels.channels; ++c) {
            float& pi = texels.values[i.index * static_cast<std::size_t>(texels.channels) +
                                      static_cast<std::size_t>(c)];
            if (n[c] > 0) pi = clamp01(pi - rate * m[c] / std::sqrt(n[c]));
        }
    }
}

struct IterationDifferences {
    double loss = 0, texture = 0;  ///< relative; in steps of the optimiser
};

/// The largest differences over some iterations.
IterationDifferences follow(const PairOfRuns& runs, std::uint32_t iterations = kIterations) {
    Solver solver(runs.fast, runs.options);
    SlowState state;
    state.pi = test::theta_of(runs.fast.renderer.data().scene());
    IterationDifferences worst;
    for (std::uint32_t v = 0; v < iterations; ++v) {
        const double fast = solver.step().loss;
        const auto slow = reference::iterate(runs.slow, state.pi, v, state.history);
        worst.loss = test::worse(worst.loss, std::abs(fast / slow.loss - 1));
        step(slow.gradient, v, runs.learning_rate, state);
        for (std::size_t t = 0; t < state.pi.textures.size(); ++t) {
            const Image &a = solver.texture(t), &b = state.pi.textures[t].values;
            for (std::size_t k = 0; k < a.values.size(); ++k)
                worst.texture = test::worse(
                    worst.texture, std::abs(double{a.values[k]} - double{b.values[k]}) / 0.01);
        }
    }
    return worst;
}

/// A step of Adam has the same size for every gradient, so a texel whose gradient is nearly nothing
/// shows rounding most.
constexpr double kLoss = 1e-5, kTexture = 1e-2;

bool agrees(const IterationDifferences& d) { return d.loss < kLoss && d.texture < kTexture; }

TEST(ReferenceIteration, IsThatOfTheSolver) {
    for (const Shift shift : {Shift::kReplay, Shift::kIdentity}) {
        const IterationDifferences d = follow(make_runs(shift));
        EXPECT_LT(d.loss, kLoss);
        EXPECT_LT(d.texture, kTexture);
    }
}

TEST(ReferenceIteration, DefectsAreSeen) {
    const auto is_seen = [](const auto& change) {
        PairOfRuns runs = make_runs(Shift::kIdentity);
        change(runs);
        return !agrees(follow(runs));
    };
    EXPECT_FALSE(is_seen([](PairOfRuns&) {}));
    EXPECT_TRUE(is_seen([](PairOfRuns& r) { r.learning_rate = 0.0102f; }));
    EXPECT_TRUE(is_seen([](PairOfRuns& r) { r.slow.target.values[100] *= 1.1f; }));
    EXPECT_TRUE(is_seen([](PairOfRuns& r) { r.slow.M_cap = 1.5f; }));
    EXPECT_TRUE(is_seen([](PairOfRuns& r) { r.slow.shift = Shift::kReplay; }));
    EXPECT_TRUE(is_seen([](PairOfRuns& r) { r.slow.derivative.key.stream = Stream::kImage; }));
    EXPECT_TRUE(is_seen([](PairOfRuns& r) { r.slow.image.key.stream = Stream::kDerivative; }));
    EXPECT_TRUE(is_seen(
        [](PairOfRuns& r) { std::get<Reservoirs>(r.options.estimator).positivization = false; }));
    EXPECT_TRUE(
        is_seen([](PairOfRuns& r) { std::get<Reservoirs>(r.options.estimator).reuse = false; }));
}

}  // namespace
}  // namespace burnish
