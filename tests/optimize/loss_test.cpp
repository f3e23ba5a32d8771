// Losses: values against the formula, adjoints against central differences.
#include "optimize/loss.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "images.h"
#include "optimize/option_value.h"
#include "optimize/small_problem.h"
#include "optimize/view_loss.h"
#include "worst.h"

namespace burnish {
namespace {

/// The largest deviation of `adjoint` from central differences of the value, relative to its own
/// largest entry.
double worst_difference(Loss loss, const Image& image, const Image& target, const Image& mask,
                        const Image& adjoint) {
    double worst = 0, scale = 0;
    for (std::size_t i = 0; i < image.values.size(); ++i) {
        Image up = image, down = image;
        up.values[i] += 0x1p-10f, down.values[i] -= 0x1p-10f;  // exact in float
        const double step = double{up.values[i]} - double{down.values[i]};
        const double slope = (evaluate_loss(loss, up, target, mask).value -
                              evaluate_loss(loss, down, target, mask).value) /
                             step;
        worst = test::worse(worst, std::abs(slope - double{adjoint.values[i]}));
        scale = std::max(scale, std::abs(slope));
    }
    return worst / scale;
}

TEST(Loss, AdjointIsTheDerivativeOfTheValue) {
    const Image image = test::random_image(5, 3, 3, 0, 2, 1),
                target = test::random_image(5, 3, 3, 0, 2, 2);
    for (const auto& [name, loss] : choices<Loss>())
        for (const Image& mask : {Image{}, test::random_image(5, 3, 1, 0, 2, 3),
                                  test::random_image(5, 3, 3, 0, 2, 4)}) {
            SCOPED_TRACE(name);
            LossValue value = evaluate_loss(loss, image, target, mask);
            EXPECT_GT(value.value, 0);
            // Quadratic losses: central differences are exact up to the rounding of the adjoint.
            EXPECT_LT(worst_difference(loss, image, target, mask, value.adjoint), 1e-6);
            auto& entries = value.adjoint.values;
            *std::max_element(entries.begin(), entries.end()) *= 1.001f;
            EXPECT_GT(worst_difference(loss, image, target, mask, value.adjoint), 1e-6)
                << "a wrong entry must be seen";
        }
}

TEST(Loss, ValuesFollowTheirFormulas) {
    const Image image = {1, 1, 3, {1.0f, 2.0f, 0.5f}}, target = {1, 1, 3, {0.5f, 2.0f, 1.5f}};
    EXPECT_NEAR(evaluate_loss(Loss::kRelMse, image, target, {}).value,
                (0.25 / 0.26 + 0 + 1 / 2.26) / 3, 1e-12);
    EXPECT_NEAR(evaluate_loss(Loss::kL2, image, target, {}).value, 1.25 / 3, 1e-12);
    EXPECT_NEAR(evaluate_loss(Loss::kL1, image, target, {}).value, 1.5 / 3, 1e-12);
}

/// A weight is a factor of its channel's term, between 0 and 1, too.
TEST(Loss, MasksWeighInProportionAndByChannel) {
    const Image image = {1, 1, 3, {1.0f, 2.5f, 0.5f}}, target = {1, 1, 3, {0.5f, 2.0f, 1.5f}};
    const Image mask = {1, 1, 3, {1.0f, 0.5f, 0.25f}}, quarter = {1, 1, 1, {0.25f}};
    EXPECT_NEAR(evaluate_loss(Loss::kRelMse, image, target, mask).value,
                (0.25 / 0.26 + 0.5 * 0.25 / 4.01 + 0.25 / 2.26) / 3, 1e-12);
    EXPECT_NEAR(evaluate_loss(Loss::kL1, image, target, mask).value, (0.5 + 0.25 + 0.25) / 3,
                1e-12);
    for (const auto& [name, loss] : choices<Loss>())
        EXPECT_NEAR(evaluate_loss(loss, image, target, quarter).value,
                    0.25 * evaluate_loss(loss, image, target, {}).value, 1e-12)
            << name;
}

TEST(Loss, MaskOfOnesChangesNothingAndMaskOfZerosRemovesAPixel) {
    const Image image = test::random_image(4, 4, 3, 0, 2, 5),
                target = test::random_image(4, 4, 3, 0, 2, 6);
    const LossValue plain = evaluate_loss(Loss::kRelMse, image, target, {});
    const LossValue ones = evaluate_loss(Loss::kRelMse, image, target, make_image(4, 4, 1, 1.0f));
    EXPECT_EQ(plain.value, ones.value);
    EXPECT_EQ(plain.value, loss_value(Loss::kRelMse, image, target, {}));
    EXPECT_EQ(plain.adjoint.values, ones.adjoint.values);
    Image mask = make_image(4, 4, 1, 1.0f);
    mask.at(2, 1, 0) = 0;
    const LossValue masked = evaluate_loss(Loss::kRelMse, image, target, mask);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(masked.adjoint.at(2, 1, c), 0.0f);
    EXPECT_EQ(masked.adjoint.at(1, 1, 0), plain.adjoint.at(1, 1, 0)) << "the mean is not shortened";
}

/// The mean over all signs of a noise on two halves, the same in every pixel.
template <class Value>
double mean_over_noise(const Image& image, const Image& noise, const Value& value) {
    const auto add = [&](float sign) {
        Image noisy = image;
        for (std::size_t i = 0; i < noisy.values.size(); ++i)
            noisy.values[i] += sign * noise.values[i];
        return noisy;
    };
    double sum = 0;
    for (const float a : {-1.0f, 1.0f})
        for (const float b : {-1.0f, 1.0f}) sum += value(add(a), add(b));
    return sum / 4;
}

TEST(Loss, OfHalvesHoldsNoNoise) {
    const Image image = test::random_image(5, 4, 3, 0, 2, 21),
                target = test::random_image(5, 4, 3, 0, 2, 22);
    const Image noise = test::random_image(5, 4, 3, 0, 2, 23),
                mask = test::random_image(5, 4, 1, 0, 2, 24);
    for (const Loss loss : {Loss::kRelMse, Loss::kL2}) {
        const double truth = loss_value(loss, image, target, mask);
        const auto halves = [&](const Image& a, const Image& b) {
            return loss_of_halves(loss, a, b, target, mask);
        };
        EXPECT_NEAR(mean_over_noise(image, noise, halves), truth, 1e-5 * truth);
        const auto once = [&](const Image& a, const Image&) {
            return loss_value(loss, a, target, mask);
        };
        EXPECT_GT(mean_over_noise(image, noise, once), 1.1 * truth) << "noise must be seen";
    }
    EXPECT_NEAR(loss_of_halves(Loss::kL1, image, image, target, mask),
                loss_value(Loss::kL1, image, target, mask), 1e-9);
}

/// An unbiased gradient needs an adjoint that is affine in the image: its second difference is 0.
double second_difference(Loss loss) {
    const Image target = test::random_image(4, 4, 3, 0, 2, 8),
                a = test::random_image(4, 4, 3, 0, 2, 9);
    const Image b = test::random_image(4, 4, 3, 0, 2, 10);
    Image middle = a;
    for (std::size_t i = 0; i < a.values.size(); ++i)
        middle.values[i] = 0.5f * (a.values[i] + b.values[i]);
    const auto adjoint = [&](const Image& i) { return evaluate_loss(loss, i, target, {}).adjoint; };
    const Image ga = adjoint(a), gb = adjoint(b), gm = adjoint(middle);
    double worst = 0, scale = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        worst = test::worse(worst, std::abs(0.5 * (double{ga.values[i]} + double{gb.values[i]}) -
                                            double{gm.values[i]}));
        scale = std::max(scale, std::abs(double{ga.values[i]}));
    }
    return worst / scale;
}

TEST(Loss, ThoseThatClaimToBeUnbiasedAreAffineInTheImage) {
    for (const auto& [name, loss] : choices<Loss>())
        EXPECT_EQ(second_difference(loss) < 1e-6, is_unbiased(loss)) << name;
    EXPECT_TRUE(is_unbiased(Loss::kRelMse));
    EXPECT_TRUE(is_unbiased(Loss::kReweighted));
    EXPECT_TRUE(is_unbiased(Loss::kL2));
    EXPECT_FALSE(is_unbiased(Loss::kL1));
    EXPECT_GT(second_difference(Loss::kL1), 1e-2);
}

/// In each half a pixel is weighed by the other one, exposed, where that is brighter than the
/// target.
TEST(Loss, ReweightedPixelsAreThoseThatAreTooBright) {
    burnish::Setup setup = make_setup(test::problem_of(test::small_scene_of(24)), {});
    Image& target = setup.problem.views[0].image;
    target.values[7] = -0.2f;  // as photographs may hold after lens corrections
    const auto noisy = [&](std::uint32_t seed) {
        return test::random_image(24, 24, 3, 0, 1, seed);
    };
    const std::vector<Image> images{noisy(31), noisy(32)};
    std::vector<Image> adjoints(2, make_image(24, 24, 3, 1.0f));
    const ExposureFactors exposure{0.5f, 1, 2};
    reweigh(setup, 0, exposure, images, adjoints);
    std::size_t changed = 0;
    for (std::size_t h = 0; h < 2; ++h)
        for (std::size_t i = 0; i < target.values.size(); ++i) {
            const double g = std::abs(double{target.values[i]}),
                         j = double{exposure[i % 3]} * double{images[1 - h].values[i]},
                         max = std::max(j, g);
            EXPECT_NEAR(double{adjoints[h].values[i]}, (g * g + 0.01) / (max * max + 0.01), 1e-6);
            changed += adjoints[h].values[i] != 1;
        }
    EXPECT_GT(changed, 100u);
    EXPECT_LT(changed, 2 * target.values.size() - 100);
}

}  // namespace
}  // namespace burnish
