// The background: which pixels get passes when, and what their mean is.
#include "gradient/background.h"

#include <gtest/gtest.h>

#include "gradient/small_scene.h"
#include "images.h"
#include "render/render.h"

namespace burnish {
namespace {

TEST(Background, IsTheMeanOfItsPasses) {
    const Image two = test::random_image(4, 3, 3, 0, 1, 1),
                three = test::random_image(4, 3, 3, 0, 1, 2),
                one = test::random_image(4, 3, 3, 0, 1, 3);
    std::vector<char> only(12, 0);
    only[5] = only[7] = 1;
    Background background;
    add_passes(two, 2, {}, background);
    add_passes(three, 3, {}, background);
    add_passes(one, 1, only, background);
    EXPECT_EQ(background.passes, 6u);
    for (std::size_t i = 0; i < 12; ++i) {
        EXPECT_EQ(background.counts[i], only[i] ? 6u : 5u);
        for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) {
            const float sum = 2 * two.values[k] + 3 * three.values[k];
            EXPECT_NEAR(background.mean.values[k], only[i] ? (sum + one.values[k]) / 6 : sum / 5,
                        1e-6f);
        }
    }
}

/// The small scene in a corner of a larger film, so that pixels lie far from all unknowns.
Scene make_corner_scene() {
    Scene scene = test::make_small_scene();
    scene.camera.fov_x = 90;
    scene.film = {32, 32, 0, 0, 32, 32, scene.film.filter};
    return scene;
}

TEST(Background, GathersEverywhereAtFirstAndNearUnknownsUntilItHasEnough) {
    const Scene scene = make_corner_scene();
    const Theta theta = test::theta_of(scene);
    const TracedScene traced = prepare(scene);
    const Binding binding(traced, theta);
    const NearUnknown near = near_unknown(binding.film(), reaching_pixels(binding));
    const BackgroundOptions options{4, 20, 5};
    Background background;
    gather_background(binding, near, options, 0, background);
    EXPECT_EQ(background.mean,
              render(constant_part(binding, {5, Stream::kImage}), 0, options.passes));
    for (std::uint32_t v = 1; v <= 8; ++v) gather_background(binding, near, options, v, background);
    std::size_t far = 0;
    for (std::size_t i = 0; i < background.counts.size(); ++i) {
        far += !near.pixels[i];
        // Iterations 0 to 4 and 8 near unknowns, where twenty passes are enough; 0 and 8 elsewhere.
        EXPECT_EQ(background.counts[i], near.pixels[i] ? 24u : 8u) << i;
    }
    EXPECT_GT(far, 50u);
    EXPECT_LT(far, background.counts.size());
}

}  // namespace
}  // namespace burnish
