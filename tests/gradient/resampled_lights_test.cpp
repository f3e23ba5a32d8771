// Reservoirs of light samples that are resampled, as a run chooses them by default, agree in
// expectation with the baseline of lights that are chosen uniformly: with a candidate of each
// emitter, and with candidates that are drawn from many.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "gradient/estimator_script.h"
#include "paths/lamps.h"

namespace burnish {
namespace {

using test::Estimates;
using test::scaled;
using test::Script;
using test::seed_of;
using test::ledger::kResampledLights;

/// The small scene with nine more panels above the picture, which face down, each brighter than the
/// one before.
Scene make_twelve_lights() {
    Scene scene = test::make_small_scene();
    for (int i = 0; i < 9; ++i) {
        const float x = -0.8f + 0.7f * static_cast<float>(i % 3),
                    y = -0.8f + 0.7f * static_cast<float>(i / 3);
        const float radiance = 4 + 4 * static_cast<float>(i);
        test::add_lamp(scene, test::make_quad({x, y, 1.4f}, {0, 0.2f, 0}, {0.2f, 0, 0}),
                       {radiance, radiance, 0.5f * radiance});
    }
    return scene;
}

Estimates estimates_of(const Script& script, const Estimator& estimator, std::size_t runs,
                       std::uint32_t offset) {
    return test::sum_runs(test::runs_along(script, estimator, scaled(kResampledLights, runs),
                                           seed_of(kResampledLights, offset)),
                          script.direction);
}

/// samples: of the baseline, per pixel.
void expect_agreement(const Scene& scene, std::uint32_t samples, std::uint32_t offset) {
    Script script = test::make_script(scene, true);
    const Estimates uniform = estimates_of(script, test::mc(samples), 200, offset + 4000);
    script.lights = LightSelection::kResampled;
    Reservoirs identity = test::by_integrand(test::pgris());
    identity.confidence_cap = 4;
    Reservoirs replay = identity;
    replay.shift = Shift::kReplay;
    for (const Reservoirs& o : {replay, identity}) {
        const Estimates resampled = estimates_of(script, o, 300, offset);
        EXPECT_TRUE(
            accepted(kResampledLights,
                     fmt::format("{} emitters, {}", scene.emitters.size(), test::name_of(o.shift)),
                     test::agreement_p_value(resampled, uniform)));
        EXPECT_TRUE(rejected(kResampledLights, "gradient a quarter larger",
                             test::agreement_p_value(test::larger_by(1.25, resampled), uniform)));
    }
}

TEST(ResampledLights, GiveReservoirsTheExpectationOfUniformOnes) {
    const Scene few = test::make_small_scene(), many = make_twelve_lights();
    ASSERT_EQ(few.emitters.size(), 3u);
    ASSERT_EQ(many.emitters.size(), 12u) << "more than there are candidates";
    expect_agreement(few, 8, 0);
    expect_agreement(many, 16, 10000);
}

}  // namespace
}  // namespace burnish
