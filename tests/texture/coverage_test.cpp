// What pictures say about texels, and errors over the texels that they tell.
#include "texture/coverage.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "gradient/small_scene.h"
#include "ledger_entries.h"
#include "student.h"

namespace burnish {
namespace {

/// Two of three texels are visited: their channels differ by 0.3 and 0.1, the third by 1.
TEST(TextureError, IsTheRootOfTheMeanSquareOverVisitedTexels) {
    Image texels = make_image(3, 1, 3, 0.5f);
    const Image truth = texels;
    for (int c = 0; c < 3; ++c) {
        texels.at(0, 0, c) += 0.3f;
        texels.at(1, 0, c) -= 0.1f;
        texels.at(2, 0, c) += 1.0f;
    }
    EXPECT_NEAR(texture_error(texels, truth, {1, 1, 0}), std::sqrt((0.09 + 0.01) / 2), 1e-6);
    EXPECT_NEAR(texture_error(texels, truth, {0, 1, 0}), 0.1, 1e-6);
    EXPECT_TRUE(std::isnan(texture_error(texels, truth, {0, 0, 0})));
}

TEST(TextureError, WeighsTexelsWithTheirSensitivity) {
    const Image truth = make_image(3, 1, 1, 0.5f);
    Image texels = truth;
    texels.values = {0.6f, 0.8f, 0.0f};
    EXPECT_NEAR(weighted_texture_error(texels, truth, {3, 1, 0}), std::sqrt((3 * 0.01 + 0.09) / 4),
                1e-6);
    EXPECT_TRUE(std::isnan(weighted_texture_error(texels, truth, {0, 0, 0})));
    EXPECT_TRUE(std::isnan(weighted_texture_error(texels, truth, {2, 1, -1})));
    EXPECT_EQ(weighted_texture_error(truth, truth, {-1, 2, 3}), 0.0);
}

using test::ledger::kTexelEvidence;

/// Sums over the texels and channels of a base colour, in which the image is affine.
struct Sensitivity {
    Scene scene = test::make_small_scene();
    TracedScene traced = prepare(scene);
    Theta theta = test::theta_of(scene);
    Image weights = make_image(scene.film.crop_width, scene.film.crop_height, 3);

    Sensitivity() {
        theta.textures.resize(1);
        for (std::size_t i = 0; i < weights.values.size(); ++i)
            weights.values[i] = 0.5f + static_cast<float>(i % 7);
    }

    Image image(std::uint32_t seed, std::uint32_t passes = 16) const {
        const TextureTable textures = texture_table(scene, theta);
        TraceInput input;
        input.scene = &traced, input.textures = &textures;
        input.key = {seed, Stream::kTest};
        return render(input, 0, passes);
    }

    /// From differences of images of two seeds.
    double by_differences(std::array<std::uint32_t, 2> seeds, std::uint32_t passes = 16) {
        constexpr double kChange = 0.1;
        const std::array<Image, 2> before{image(seeds[0], passes), image(seeds[1], passes)};
        double sum = 0;
        for (float& value : theta.textures[0].values.values) {
            const float was = value;
            value += static_cast<float>(kChange);
            const std::array<Image, 2> after{image(seeds[0], passes), image(seeds[1], passes)};
            value = was;
            const auto change = [&](std::size_t half, std::size_t i) {
                return (double{after[half].values[i]} - double{before[half].values[i]}) / kChange;
            };
            for (std::size_t i = 0; i < weights.values.size(); ++i)
                sum += double{weights.values[i]} * change(0, i) * change(1, i);
        }
        return sum;
    }

    double by_signs(std::uint32_t seed) const {
        double sum = 0;
        const TexelEvidence evidence = texel_evidence(traced, theta, weights, seed, 128)[0];
        for (const float s : evidence.sensitivity) sum += double{s};
        return sum;
    }
};

TEST(TexelEvidence, IsTheDiagonalOfTheGaussNewtonMatrix) {
    Sensitivity of;
    test::RunningMean difference, defect;
    const auto batches = scaled(kTexelEvidence, 72u);
    for (std::uint32_t k = 0; k < batches; ++k) {
        const auto seed = [&](std::uint32_t i) { return seed_of(kTexelEvidence, 4 * k + i); };
        const double signs = of.by_signs(seed(0));
        difference.add(signs - of.by_differences({seed(1), seed(2)}));
        defect.add(signs - of.by_differences({seed(3), seed(3)}, 1));
    }
    const auto p_value = [](const test::RunningMean& m) {
        return test::student_p_value(m.mean / m.standard_error(), m.count - 1);
    };
    EXPECT_TRUE(accepted(kTexelEvidence, "base colour", p_value(difference)));
    EXPECT_TRUE(rejected(kTexelEvidence, "squares of one sample", p_value(defect)));
}

TEST(TexelEvidence, KnowsWhichTexelsArePartOfThePicture) {
    Sensitivity of;
    const TexelEvidence evidence = texel_evidence(of.traced, of.theta, of.weights, 1, 256)[0];
    for (std::size_t texel = 0; texel < evidence.visited.size(); ++texel) {
        const Image before = of.image(1);
        float& value = of.theta.textures[0].values.values[3 * texel];
        const float was = value;
        value = 0;
        EXPECT_EQ(evidence.visited[texel] != 0, of.image(1) != before) << texel;
        value = was;
    }
}

}  // namespace
}  // namespace burnish
