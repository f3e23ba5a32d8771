// Adam and SGD against sequences computed by hand.
#include "burnish/inverse/optimizer.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "random_source.h"

namespace burnish {
namespace {

TEST(Adam, FollowsASequenceComputedByHand) {
    OptimizerOptions options;
    options.learning_rate = 0.1f;
    OptimizerState state;
    std::array<float, 1> x{1.0f};
    // Step 1, g = 2: m = 0.2, v = 0.004, rate = 0.1 sqrt(0.001) / 0.1 = 0.0316227766;
    // x = 1 - 0.0316227766 * 0.2 / 0.0632455532 = 0.9.
    step(options, std::array{2.0f}, state, x);
    EXPECT_NEAR(x[0], 0.9f, 1e-6f);
    // Step 2, g = -1: m = 0.9 * 0.2 - 0.1 = 0.08, v = 0.999 * 0.004 + 0.001 = 0.004996,
    // rate = 0.1 sqrt(0.001999) / 0.19 = 0.0235316; x = 0.9 - 0.0235316 * 0.08 / 0.0706824.
    step(options, std::array{-1.0f}, state, x);
    EXPECT_NEAR(x[0], 0.9f - 0.02663386f, 2e-6f);
    // Step 3, g = 0: m = 0.072, v = 0.004991004, rate = 0.1 sqrt(0.002997001) / 0.271.
    step(options, std::array{0.0f}, state, x);
    const double rate = 0.1 * std::sqrt(0.002997001) / 0.271;
    EXPECT_NEAR(x[0], 0.87336614 - rate * 0.072 / std::sqrt(0.004991004), 3e-6);
    EXPECT_EQ(state.steps, 3u);
}

/// Adam in its textbook form, with bias-corrected moments, in double.
double textbook_adam(const OptimizerOptions& o, const std::vector<float>& gradients, double x) {
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
    OptimizerOptions options;
    test::RandomSource random{11};
    std::vector<float> gradients;
    for (int i = 0; i < 200; ++i) gradients.push_back(random.next(-1.0f, 2.0f));
    OptimizerState state;
    std::array<float, 1> x{0.25f};
    for (const float g : gradients) step(options, std::array{g}, state, x);
    EXPECT_NEAR(x[0], textbook_adam(options, gradients, 0.25), 2e-5);
    OptimizerOptions wrong = options;
    wrong.beta2 = 0.99f;
    EXPECT_GT(std::abs(double{x[0]} - textbook_adam(wrong, gradients, 0.25)), 2e-5);
}

TEST(Adam, MovesAParameterAsIfItWereAlone) {
    OptimizerOptions options;
    OptimizerState together, alone;
    std::array<float, 3> x{0.1f, 0.2f, 0.3f};
    std::array<float, 1> y{0.2f};
    for (int i = 0; i < 5; ++i) {
        const float g = static_cast<float>(i) - 1.5f;
        step(options, std::array{5.0f, g, -7.0f}, together, x);
        step(options, std::array{g}, alone, y);
    }
    EXPECT_EQ(x[1], y[0]);
}

TEST(Sgd, CarriesItsVelocity) {
    OptimizerOptions options;
    options.kind = Optimizer::kSgd;
    options.learning_rate = 0.5f;
    options.momentum = 0.5f;
    OptimizerState state;
    std::array<float, 1> x{1.0f};
    step(options, std::array{1.0f}, state, x);  // velocity 1
    EXPECT_EQ(x[0], 0.5f);
    step(options, std::array{-2.0f}, state, x);  // velocity -1.5
    EXPECT_EQ(x[0], 1.25f);
}

}  // namespace
}  // namespace burnish
