// Adam against sequences computed by hand, its gate, damping and weight decay against their
// definitions.
#include "texture/adam.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "random_source.h"
#include "worst.h"

namespace burnish {
namespace {

/// Of an array that has all of its parameters.
void step(const AdamOptions& options, const GradientSpans& gradient, AdamState& state,
          std::span<float> parameters) {
    step(options, gradient, root_sum(state), state, parameters);
}

TEST(Adam, FollowsASequenceComputedByHand) {
    AdamOptions options;
    options.learning_rate = 0.1f;
    AdamState state;
    std::array<float, 1> x{1.0f};
    // Step 1, g = 2: m = 0.2, v = 0.004, rate = 0.1 sqrt(0.001) / 0.1 = 0.0316227766;
    // x = 1 - 0.0316227766 * 0.2 / 0.0632455532 = 0.9.
    step(options, {std::array{2.0f}, {}}, state, x);
    EXPECT_NEAR(x[0], 0.9f, 1e-6f);
    // Step 2, g = -1: m = 0.9 * 0.2 - 0.1 = 0.08, v = 0.999 * 0.004 + 0.001 = 0.004996,
    // rate = 0.1 sqrt(0.001999) / 0.19 = 0.0235316; x = 0.9 - 0.0235316 * 0.08 / 0.0706824.
    step(options, {std::array{-1.0f}, {}}, state, x);
    EXPECT_NEAR(x[0], 0.9f - 0.02663386f, 2e-6f);
    // Step 3, g = 0: m = 0.072, v = 0.004991004, rate = 0.1 sqrt(0.002997001) / 0.271.
    step(options, {std::array{0.0f}, {}}, state, x);
    const double rate = 0.1 * std::sqrt(0.002997001) / 0.271;
    EXPECT_NEAR(x[0], 0.87336614 - rate * 0.072 / std::sqrt(0.004991004), 3e-6);
    EXPECT_EQ(state.steps, 3u);
}

/// Adam in its textbook form, with bias-corrected moments, in double.
double textbook_adam(const AdamOptions& o, const std::vector<float>& gradients, double x) {
    double m = 0, v = 0;
    for (std::size_t i = 0; i < gradients.size(); ++i) {
        const double t = static_cast<double>(i + 1), g = double{gradients[i]};
        m = double{o.beta1} * m + (1 - double{o.beta1}) * g;
        v = double{o.beta2} * v + (1 - double{o.beta2}) * g * g;
        const double mean = m / (1 - std::pow(double{o.beta1}, t));
        const double square = v / (1 - std::pow(double{o.beta2}, t));
        x -= double{o.learning_rate} * mean / std::sqrt(square);
    }
    return x;
}

TEST(Adam, AgreesWithItsTextbookFormOverManySteps) {
    AdamOptions options;
    test::RandomSource random{11};
    std::vector<float> gradients;
    for (int i = 0; i < 200; ++i) gradients.push_back(random.next(-1.0f, 2.0f));
    AdamState state;
    std::array<float, 1> x{0.25f};
    for (const float g : gradients) step(options, {std::array{g}, {}}, state, x);
    EXPECT_NEAR(x[0], textbook_adam(options, gradients, 0.25), 2e-5);
    AdamOptions wrong = options;
    wrong.beta2 = 0.99f;
    EXPECT_GT(std::abs(double{x[0]} - textbook_adam(wrong, gradients, 0.25)), 2e-5);
}

TEST(Adam, MovesAParameterAsIfItWereAlone) {
    AdamOptions options;
    AdamState together, alone;
    std::array<float, 3> x{0.1f, 0.2f, 0.3f};
    std::array<float, 1> y{0.2f};
    for (int i = 0; i < 5; ++i) {
        const float g = static_cast<float>(i) - 1.5f;
        step(options, {std::array{5.0f, g, -7.0f}, {}}, together, x);
        step(options, {std::array{g}, {}}, alone, y);
    }
    EXPECT_EQ(x[1], y[0]);
}

/// Powers of two scale exactly: so do both moments and, with the gate, the noise.
TEST(Adam, TakesTheSameStepsWhateverTheScaleOfTheGradient) {
    for (const bool gate : {false, true}) {
        AdamOptions options;
        options.gate = gate;
        options.damping = 0.5f;
        constexpr std::array kPowers{0, -20, -40, 20, 50};
        std::array<AdamState, kPowers.size()> states;
        std::array<std::array<float, 1>, kPowers.size()> x{};
        test::RandomSource random{5};
        for (int i = 0; i < 40; ++i) {
            const float a = random.next(-1.0f, 2.0f), b = random.next(-1.0f, 2.0f);
            for (std::size_t k = 0; k < kPowers.size(); ++k) {
                const float scale = std::ldexp(1.0f, kPowers[k]);
                step(options, {std::array{scale * a}, std::array{scale * b}}, states[k], x[k]);
            }
        }
        EXPECT_NE(x[0][0], 0.0f);
        for (std::size_t k = 1; k < kPowers.size(); ++k) EXPECT_EQ(x[k], x[0]) << kPowers[k];
    }
}

TEST(Adam, StaysWhereNoGradientWas) {
    AdamState state;
    std::array<float, 2> x{0.3f, 0.3f};
    for (int i = 0; i < 3; ++i) step({}, {std::array{0.0f, 1.0f}, {}}, state, x);
    EXPECT_EQ(x[0], 0.3f);
    EXPECT_NE(x[1], 0.3f);
}

constexpr float kStep = 0.01f;

AdamOptions gated_options(bool gate = true) {
    AdamOptions options;
    options.gate = gate;
    options.learning_rate = kStep;
    return options;
}

TEST(Gate, FollowsItsDefinitionInDoubles) {
    const AdamOptions o = gated_options();
    test::RandomSource random{12};
    AdamState state;
    std::array<float, 1> x{0.5f};
    double m = 0, v = 0, n = 0, expected = 0.5, adam = 0.5;
    for (int t = 1; t <= 100; ++t) {
        const float a = random.next(-0.5f, 1.0f), b = random.next(-0.5f, 1.0f);
        step(o, {std::array{a}, std::array{b}}, state, x);
        const double g = double{a} + double{b}, d = double{a} - double{b};
        m = double{o.beta1} * m + (1 - double{o.beta1}) * g;
        v = double{o.beta2} * v + (1 - double{o.beta2}) * g * g;
        n = double{o.beta2} * n + (1 - double{o.beta2}) * d * d;
        const double full = double{kStep} * std::sqrt(1 - std::pow(double{o.beta2}, t)) /
                            (1 - std::pow(double{o.beta1}, t)) * m / std::sqrt(v);
        expected -= std::max(0.0, 1 - n / v) * full;
        adam -= full;
    }
    EXPECT_NEAR(x[0], expected, 1e-5);
    EXPECT_GT(std::abs(double{x[0]} - adam), 1e-2);
}

/// Root mean square of the parameters after 300 steps from 0. halves(k): those of step k.
template <class Halves>
double distance(bool gate, const Halves& halves) {
    constexpr std::size_t kCount = 5000;
    const AdamOptions options = gated_options(gate);
    AdamState state;
    std::vector<float> x(kCount, 0.0f), a(kCount), b(kCount);
    for (int k = 0; k < 300; ++k) {
        for (std::size_t i = 0; i < kCount; ++i) std::tie(a[i], b[i]) = halves();
        step(options, {a, b}, state, x);
    }
    double sum = 0;
    for (const float value : x) sum += double{value} * double{value};
    return std::sqrt(sum / kCount);
}

TEST(Gate, IsOpenWhereTheHalvesAreEqual) {
    const auto moved = [](bool gate) {
        test::RandomSource random{13};
        return distance(gate, [&] {
            const float g = random.next(-0.2f, 1.0f);
            return std::pair{g, g};
        });
    };
    EXPECT_EQ(moved(true), moved(false));
}

TEST(Gate, IsOpenWhereAGradientIsNotSplit) {
    AdamState state, other;
    std::array<float, 1> x{0.5f}, y{0.5f};
    for (const float g : {1.0f, -0.5f, 2.0f}) {
        step(gated_options(), {std::array{g}, {}}, state, x);
        step(gated_options(false), {std::array{g}, {}}, other, y);
    }
    EXPECT_EQ(x[0], y[0]);
}

/// After t steps of uniform noise, 1 - n / v is about normal with the variance 4 / t, so the mean
/// square of its positive part min(1, 2 / t): over 300 steps a random walk of sqrt(0.04) = 0.2
/// times Adam's.
TEST(Gate, HardlyMovesAParameterOfWhichOnlyNoiseIsKnown) {
    const auto moved = [](bool gate) {
        test::RandomSource random{14};
        return distance(gate, [&] {
            return std::pair{random.next(-1.0f, 1.0f), random.next(-1.0f, 1.0f)};
        });
    };
    EXPECT_NEAR(moved(true) / moved(false), 0.2, 0.05);
}

/// Wiener's factor: of a mean s in noise of the variance V a share s^2 / (s^2 + V) of Adam's way is
/// left.
TEST(Gate, KeepsTheShareOfTheSignal) {
    const float s = 0.5f;  // of each half; the variance of a half is 1 / 3
    const auto moved = [&](bool gate) {
        test::RandomSource random{15};
        return distance(gate, [&] {
            return std::pair{s + random.next(-1.0f, 1.0f), s + random.next(-1.0f, 1.0f)};
        });
    };
    const double share = 4 * double{s} * double{s} / (4 * double{s} * double{s} + 2.0 / 3);
    EXPECT_NEAR(moved(true) / moved(false), share, 0.03);
}

/// Parameters of a few blocks, of which some gradient never visited one in seven and small ones one
/// in three; beside them the definition in doubles. A seeded defect, the mean over the roots of the
/// first block, is not the definition.
double distance_from_damped(bool gate, bool defect) {
    constexpr std::size_t kCount = 3 * kDirtyBlock + 5;
    AdamOptions o = gated_options(gate);
    o.damping = 0.5f;
    test::RandomSource random{16};
    AdamState state;
    std::vector<float> x(kCount, 0.5f), a(kCount, 0.0f), b(kCount, 0.0f);
    std::vector<double> m(kCount), v(kCount), n(kCount), expected(kCount, 0.5);
    double mean_root = 0;
    for (int t = 1; t <= 60; ++t) {
        for (std::size_t i = 0; i < kCount; ++i) {
            const float size = i % 3 == 0 ? 0.02f : i < kDirtyBlock ? 2.0f : 0.5f;
            if (i % 7 == 3) continue;  // never visited
            a[i] = size * random.next(-0.5f, 1.0f);
            b[i] = size * random.next(-0.5f, 1.0f);
        }
        step(o, {a, b}, state, x);
        double sum = 0, count = 0;
        for (std::size_t i = 0; i < kCount; ++i) {
            const double g = double{a[i]} + double{b[i]}, d = double{a[i]} - double{b[i]};
            m[i] = double{o.beta1} * m[i] + (1 - double{o.beta1}) * g;
            v[i] = double{o.beta2} * v[i] + (1 - double{o.beta2}) * g * g;
            n[i] = double{o.beta2} * n[i] + (1 - double{o.beta2}) * d * d;
            if (v[i] == 0) continue;
            const double root = double{o.damping} * mean_root;
            expected[i] -= (gate ? std::max(0.0, 1 - n[i] / v[i]) : 1) * double{kStep} *
                           std::sqrt(1 - std::pow(double{o.beta2}, t)) /
                           (1 - std::pow(double{o.beta1}, t)) * m[i] /
                           std::sqrt(v[i] + root * root);
            if (defect && i >= kDirtyBlock) continue;
            sum += std::sqrt(v[i]);
            ++count;
        }
        mean_root = sum / count;
    }
    double worst = 0;
    for (std::size_t i = 0; i < kCount; ++i)
        worst = test::worse(worst, std::abs(double{x[i]} - expected[i]));
    return worst;
}

TEST(Damping, FollowsItsDefinitionInDoubles) {
    for (const bool gate : {false, true}) {
        EXPECT_LT(distance_from_damped(gate, false), 1e-5);
        EXPECT_GT(distance_from_damped(gate, true), 1e-3);
    }
}

/// Adam makes steps of the same length whatever the size of a gradient. Damped, one of a hundredth
/// of the mean makes a hundredth of the others' steps, and one of a hundred times the mean none
/// that is longer.
TEST(Damping, ShortensStepsOfParametersThatMoveTheImagesLittle) {
    for (const bool damped : {false, true}) {
        AdamOptions o;
        o.learning_rate = 0.001f;
        o.damping = damped ? 1.0f : 0.0f;
        AdamState state;
        std::vector<float> x(1000, 0.0f), g(1000, 1.0f);
        g[0] = 0.01f, g[1] = 100.0f;
        for (int i = 0; i < 50; ++i) step(o, {g, {}}, state, x);
        EXPECT_NEAR(x[1] / x[2], damped ? 1.42f : 1.0f, 0.05f);
        EXPECT_NEAR(x[0] / x[2], damped ? 0.033f : 1.0f, 0.01f);
    }
}

/// Adam goes by its rate where the gradient never changes.
TEST(Adam, StepsAreLongerAtFirst) {
    for (const bool gate : {false, true}) {
        AdamOptions options;
        options.gate = gate, options.learning_rate = 0.001f, options.initial_rate = 0.004f;
        AdamState state;
        std::vector<float> x(1, 0.0f);
        const std::vector<float> g(1, 0.5f);
        for (int t = 1; t <= 60; ++t) {
            const float before = x[0];
            step(options, {g, g}, state, x);
            const float factor = t <= 10 ? 4.0f : t < 40 ? 40.0f / static_cast<float>(t) : 1.0f;
            EXPECT_NEAR(before - x[0], 0.001f * factor, 1e-5f) << t;
        }
        options.initial_rate = 0.1f;
        EXPECT_EQ(rate_at(options, 3), 4 * options.learning_rate) << "never more";
        options.initial_rate = 0.0005f;
        EXPECT_EQ(rate_at(options, 3), options.learning_rate) << "never less";
    }
}

/// Parameters of several blocks, and what weight decay draws each of them to.
struct Decaying {
    std::vector<float> x, gradient, initial;
};

Decaying random_decaying(std::uint32_t seed) {
    test::RandomSource random{seed};
    Decaying d;
    for (std::size_t i = 0; i < 2 * kDirtyBlock + 5; ++i) {
        d.x.push_back(random.next(0, 1));
        d.gradient.push_back(random.next(-1, 1));
        d.initial.push_back(i < kDirtyBlock ? random.next(0, 1) : d.initial[i - kDirtyBlock]);
    }
    return d;
}

/// The largest difference of x after 50 steps from Adam with weight decay in doubles.
double distance_from_textbook(const AdamOptions& o, const Decaying& start,
                              const std::vector<float>& initial) {
    AdamState state;
    state.initial = initial;
    std::vector<float> x = start.x;
    for (int t = 0; t < 50; ++t) step(o, {start.gradient, {}}, state, x);
    double largest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        double expected = double{start.x[i]};
        for (int t = 0; t < 50;
             ++t)  // the gradient never changes: each step is as long as the rate
            expected -= double{o.learning_rate} *
                        ((start.gradient[i] > 0 ? 1 : -1) +
                         double{o.weight_decay} * (expected - double{start.initial[i]}));
        largest = test::worse(largest, std::abs(double{x[i]} - expected));
    }
    return largest;
}

TEST(WeightDecay, DrawsParametersToWhereTheyStarted) {
    AdamOptions o;
    o.weight_decay = 3;
    Decaying d = random_decaying(21);
    const std::vector<float> one(d.initial.begin(), d.initial.begin() + kDirtyBlock);
    EXPECT_LT(distance_from_textbook(o, d, d.initial), 1e-4);
    EXPECT_LT(distance_from_textbook(o, d, one), 1e-4) << "one block stands for all";
    EXPECT_GT(distance_from_textbook(o, d, {}), 1e-2) << "a wrong start must be seen";
    std::fill(d.initial.begin(), d.initial.end(), 0.0f);
    EXPECT_LT(distance_from_textbook(o, d, {}), 1e-4) << "none is zero";
}

TEST(WeightDecay, LeavesAloneWhatNoGradientReached) {
    AdamOptions o;
    o.weight_decay = 3;
    AdamState state;
    std::vector<float> x(2 * kDirtyBlock, 1.0f), g(2 * kDirtyBlock, 0.0f);
    g[0] = 1;
    step(o, {g, {}}, state, x);
    EXPECT_LT(x[1], 1.0f) << "a block moves as a whole";
    EXPECT_EQ(x[kDirtyBlock], 1.0f);
}

TEST(WeightDecay, NeverGoesPastTheStart) {
    AdamOptions o;
    o.weight_decay = 1000;
    AdamState state;
    std::array<float, 2> x{1, 1};
    step(o, {std::array{1.0f, 0.0f}, {}}, state, x);
    EXPECT_EQ(x[1], 0.0f) << "without a gradient of its own, beside one that has one";
}

}  // namespace
}  // namespace burnish
