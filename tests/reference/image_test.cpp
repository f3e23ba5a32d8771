// The images, the film and the loss of the fast code against the reference, with the same random
// numbers: to rounding.
#include <gtest/gtest.h>

#include "gradient/small_scene.h"
#include "optimize/loss.h"
#include "reference/compare.h"
#include "render/render.h"

namespace burnish {
namespace {

using test::difference;

const ReconstructionFilter kFilters[] = {
    {FilterKind::kBox, 0.5f},      {FilterKind::kTent, 1.0f},       {FilterKind::kGaussian, 2.0f},
    {FilterKind::kMitchell, 2.0f}, {FilterKind::kCatmullRom, 2.0f}, {FilterKind::kLanczos, 3.0f},
};

/// 21 x 13 pixels cut out of 25 x 19: no multiple of a tile.
Scene scene_with(const ReconstructionFilter& filter) {
    Scene scene = test::make_small_scene();
    scene.film = {25, 19, 3, 5, 21, 13, filter};
    return scene;
}

constexpr std::uint32_t kImagePasses = 5, kImageIteration = 2;
const RandomKey kImageKey{6200, Stream::kImage};

Image fast_image(const Scene& scene) {
    const TracedScene traced = prepare(scene);
    const TextureTable textures{scene.textures, {}};
    return render({&traced, &textures, kImageKey, kImagePasses, SurfaceChoice::kAll, {}},
                  kImageIteration, kImagePasses);
}

Image slow_image(const Scene& scene) {
    const TracedScene traced = prepare(scene);
    const Theta no_unknowns;
    return reference::render({traced, no_unknowns}, {kImageKey, kImagePasses}, kImageIteration);
}

/// Sums in another order.
constexpr double kImageRounding = 2e-6;

TEST(ReferenceImage, IsThatOfTheTilesForEveryFilter) {
    for (const ReconstructionFilter& filter : kFilters) {
        const Scene scene = scene_with(filter);
        const Image slow = slow_image(scene);
        EXPECT_LT(difference(fast_image(scene), slow), kImageRounding)
            << static_cast<int>(filter.kind);
        Scene narrower = scene;
        narrower.film.filter.radius *= 0.999f;
        if (filter.kind == FilterKind::kTent || filter.kind == FilterKind::kLanczos) {
            EXPECT_GT(difference(fast_image(narrower), slow), kImageRounding);
        }
        Scene brighter = scene;
        std::get<AreaEmitter>(brighter.emitters[0]).radiance.x *= 1.0001f;
        EXPECT_GT(difference(fast_image(brighter), slow), kImageRounding);
    }
}

TEST(ReferenceImage, OfUnknownsAndTheRestAddUp) {
    const Scene scene = test::make_small_scene();
    const TracedScene traced = prepare(scene);
    const Theta theta = test::theta_of(scene);
    const Binding binding(traced, theta);
    const Image slow =
        reference::render({traced, theta}, {kImageKey, kImagePasses}, kImageIteration);
    TraceInput constant = constant_part(binding, kImageKey);
    constant.sequence = Sequence::kIndependent, constant.passes_per_iteration = kImagePasses;
    const auto error = [&](const TraceInput& rest) {
        Image fast =
            render(unknown_part(binding, kImageKey, kImagePasses), kImageIteration, kImagePasses);
        const Image other = render(rest, kImageIteration, kImagePasses);
        for (std::size_t k = 0; k < fast.values.size(); ++k) fast.values[k] += other.values[k];
        return difference(fast, slow);
    };
    EXPECT_LT(error(constant), kImageRounding);
    constant.key.seed += 1;
    EXPECT_GT(error(constant), kImageRounding);
}

TEST(ReferenceLoss, IsThatOfTheOptimiser) {
    const Scene scene = test::make_small_scene();
    const Image image = test::make_adjoint(scene, 6210, true);
    Image target = test::make_adjoint(scene, 6211, true);
    const LossValue slow = reference::relative_mse(image, target);
    const LossValue fast = evaluate_loss(Loss::kRelMse, image, target, {});
    EXPECT_NEAR(fast.value, slow.value, 1e-12 * slow.value);
    EXPECT_LT(difference(fast.adjoint, slow.adjoint), 1e-7);
    target.values[100] += 1e-4f;
    EXPECT_GT(difference(evaluate_loss(Loss::kRelMse, image, target, {}).adjoint, slow.adjoint),
              1e-7);
}

}  // namespace
}  // namespace burnish
