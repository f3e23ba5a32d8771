#include "image/quality.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "image/image.h"

namespace burnish {
namespace {

/// Of a picture without noise.
double psnr(const Image& image, const Image& reference, float white,
            std::span<const char> counting = {}) {
    return psnr_without_noise(image, image, reference, white, counting);
}

TEST(Quality, PsnrIsThatOfTheCodes) {
    const float low = srgb_to_linear(0.4f), high = srgb_to_linear(0.5f);
    const Image a = make_image(4, 3, 3, 2 * low), b = make_image(4, 3, 3, 2 * high);
    EXPECT_NEAR(psnr(a, b, 2), 20, 1e-4);
    EXPECT_TRUE(std::isinf(psnr(a, a, 2)));
    Image half = a;  // one pixel of twelve differs
    for (int c = 0; c < 3; ++c) half.at(1, 1, c) = 2 * high;
    EXPECT_NEAR(psnr(half, a, 2), 20 + 10 * std::log10(12.0), 1e-4);
    std::vector<char> values(36, 0);
    EXPECT_TRUE(std::isnan(psnr(half, a, 2, values)));
    values[15] = values[16] = values[17] = 1;
    EXPECT_NEAR(psnr(half, a, 2, values), 20, 1e-4);
    values[16] = 0;  // of two channels of that pixel one differs
    half.at(1, 1, 2) = a.at(1, 1, 2), half.at(1, 1, 1) = 100;
    EXPECT_NEAR(psnr(half, a, 2, values), 20 + 10 * std::log10(2.0), 1e-4);
    EXPECT_EQ(white_of(half, values), a.at(1, 1, 2));
}

/// Halves with noise about a picture that is 20 dB away from the reference. The noise of
/// their mean would count half a decibel.
TEST(Quality, PsnrWithoutNoiseIsThatOfThePictureWithoutNoise) {
    const Image reference = make_image(200, 150, 3, 2 * srgb_to_linear(0.5f));
    const float value = 2 * srgb_to_linear(0.4f);
    std::array<Image, 2> halves;
    std::mt19937 random(1);
    std::normal_distribution<float> noise(0, 0.06f);
    for (Image& half : halves) {
        half = make_image(200, 150, 3);
        for (float& v : half.values) v = value + noise(random);
    }
    Image mean = halves[0];
    for (std::size_t i = 0; i < mean.values.size(); ++i)
        mean.values[i] = (halves[0].values[i] + halves[1].values[i]) / 2;
    EXPECT_LT(psnr(mean, reference, 2), 19.6);
    EXPECT_NEAR(psnr_without_noise(halves[0], halves[1], reference, 2), 20, 0.15);
    const Image black = make_image(200, 150, 3), white = make_image(200, 150, 3, 5);
    EXPECT_NEAR(psnr(black, reference, 2), -20 * std::log10(0.5), 1e-4);
    EXPECT_TRUE(std::isinf(psnr(white, white, 2)));
}

/// Above white the noise of the halves does not show.
TEST(Quality, NoiseAboveWhiteCountsNothing) {
    const Image a = make_image(4, 4, 3, 3), b = make_image(4, 4, 3, 5),
                reference = make_image(4, 4, 3, 2 * srgb_to_linear(0.5f));
    EXPECT_NEAR(psnr_without_noise(a, b, reference, 2), -20 * std::log10(0.5), 1e-4);
}

TEST(Quality, AboveWhiteIsWhite) {
    EXPECT_TRUE(std::isinf(psnr(make_image(2, 2, 3, 5), make_image(2, 2, 3, 3), 2)));
}

/// Of constant images only the luminance term is left.
TEST(Quality, SsimOfConstantsIsTheTermOfTheMeans) {
    const float low = srgb_to_linear(0.4f), high = srgb_to_linear(0.5f);
    const Image a = make_image(16, 12, 3, low), b = make_image(16, 12, 3, high);
    EXPECT_NEAR(ssim(a, a, 1), 1, 1e-9);
    EXPECT_NEAR(ssim(a, b, 1), (2 * 0.4 * 0.5 + 1e-4) / (0.16 + 0.25 + 1e-4), 1e-5);
    Image stripes = a, shifted = a;
    for (int y = 0; y < 12; ++y)
        for (int x = 0; x < 16; ++x)
            for (int c = 0; c < 3; ++c) {
                stripes.at(x, y, c) = (x / 2) % 2 ? low : high;
                shifted.at(x, y, c) = (x / 2) % 2 ? high : low;
            }
    EXPECT_LT(ssim(stripes, shifted, 1), 0);
}

/// By its definition [Wang et al. 2004] in two dimensions: means, variances and covariance of luma
/// in a window of 11 x 11 pixels, a Gaussian of 1.5 that is cut at the borders.
double ssim_at(const Image& a, const Image& b, int x0, int y0) {
    double weights = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
    const auto luma = [](const Image& image, int x, int y) {
        const auto code = [&](int c) { return double{linear_to_srgb(image.at(x, y, c))}; };
        return 0.2126 * code(0) + 0.7152 * code(1) + 0.0722 * code(2);
    };
    for (int y = std::max(0, y0 - 5); y <= std::min(a.height - 1, y0 + 5); ++y)
        for (int x = std::max(0, x0 - 5); x <= std::min(a.width - 1, x0 + 5); ++x) {
            const double w =
                std::exp(-((x - x0) * (x - x0) + (y - y0) * (y - y0)) / (2 * 1.5 * 1.5));
            const double va = luma(a, x, y), vb = luma(b, x, y);
            weights += w, ma += w * va, mb += w * vb;
            aa += w * va * va, bb += w * vb * vb, ab += w * va * vb;
        }
    ma /= weights, mb /= weights;
    const double var_a = aa / weights - ma * ma, var_b = bb / weights - mb * mb,
                 covariance = ab / weights - ma * mb;
    return (2 * ma * mb + 1e-4) * (2 * covariance + 9e-4) /
           ((ma * ma + mb * mb + 1e-4) * (var_a + var_b + 9e-4));
}

TEST(Quality, SsimIsThatOfItsDefinition) {
    std::mt19937 random(2);
    std::uniform_real_distribution<float> uniform(0, 1);
    Image a = make_image(17, 9, 3), b = a;
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        a.values[i] = uniform(random);
        b.values[i] = std::min(1.0f, 0.8f * a.values[i] + 0.3f * uniform(random));
    }
    double sum = 0;
    std::vector<char> pixels(17 * 9, 0);
    for (int y = 0; y < 9; ++y)
        for (int x = 0; x < 17; ++x) sum += ssim_at(a, b, x, y);
    EXPECT_NEAR(ssim(a, b, 1), sum / (17 * 9), 1e-5);
    pixels[3 * 17 + 14] = pixels[8 * 17 + 2] = 1;
    EXPECT_NEAR(ssim(a, b, 1, pixels), (ssim_at(a, b, 14, 3) + ssim_at(a, b, 2, 8)) / 2, 1e-5);
}

TEST(Quality, AValueCountsWhereItsMaskHasWeight) {
    EXPECT_TRUE(counted_values({}).empty());
    EXPECT_TRUE(counted_pixels({}).empty());
    Image mask = make_image(2, 1, 1);
    mask.at(1, 0, 0) = 0.5f;
    EXPECT_EQ(counted_values(mask), (std::vector<char>{0, 0, 0, 1, 1, 1}));
    EXPECT_EQ(counted_pixels(mask), (std::vector<char>{0, 1}));
    mask = make_image(2, 1, 3);
    mask.at(0, 0, 2) = 2;
    EXPECT_EQ(counted_values(mask), (std::vector<char>{0, 0, 1, 0, 0, 0}));
    EXPECT_EQ(counted_pixels(mask), (std::vector<char>{1, 0}));
    const Image image = make_image(2, 1, 3, 1.0f), reference = make_image(2, 1, 3, 3.0f);
    EXPECT_EQ(alike_where_uncounted(reference, image, mask).values,
              (std::vector<float>{1, 1, 3, 1, 1, 1}));
    EXPECT_EQ(alike_where_uncounted(reference, image, {}), reference);
}

TEST(Quality, QuantilesAreThoseOfTheValuesThatCount) {
    Image image = make_image(11, 1, 1);
    for (int x = 0; x < 11; ++x) image.at(x, 0, 0) = static_cast<float>(x);
    EXPECT_EQ(quantile(image, 0.5), 5);
    EXPECT_EQ(quantile(image, 1), 10);
    std::vector<char> pixels(11, 0);
    pixels[3] = pixels[7] = 1;
    EXPECT_EQ(quantile(image, 0, pixels), 3);
    EXPECT_EQ(quantile(image, 1, pixels), 7);
    Image ramp = make_image(101, 1, 1);
    for (int x = 0; x < 101; ++x) ramp.at(x, 0, 0) = static_cast<float>(x);
    EXPECT_EQ(white_of(ramp), 99);
    EXPECT_GT(white_of(make_image(2, 2, 3)), 0);
}

}  // namespace
}  // namespace burnish
