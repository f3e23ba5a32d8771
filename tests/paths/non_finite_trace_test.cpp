// Light and densities that are not finite: each sample that they spoil is counted, none is kept,
// and the others are as they were.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gradient/small_scene.h"
#include "paths/trace.h"

namespace burnish {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Two textured surfaces under a sky.
Scene make_scene(bool bounces) {
    Scene scene = test::make_small_scene();
    scene.shapes.resize(1);
    scene.shapes.push_back({"wall", test::make_quad({-1, 1, 0}, {2, 0, 0}, {0, 0, 2}), {0}, {}});
    scene.emitters = {EnvironmentEmitter{share(make_image(1024, 512, 3, 0.7f)), 1, {}}};
    if (bounces) scene.max_depth = 4;
    return scene;
}

enum class Place { kRadiance, kDensity };

/// The lights with so large a share of the sky's texels spoiled, one at least.
std::shared_ptr<const Lights> spoiled(const Lights& lights, Place place, double rate, float value) {
    auto all = std::make_shared<Lights>(lights);
    auto sky = std::make_shared<SkyTable>(*all->environment->sky);
    auto& texels = sky->texels;
    test::RandomSource random{90};
    const auto count = std::max(1.0, rate * static_cast<double>(texels.size()));
    for (int k = 0; k < static_cast<int>(count); ++k) {
        auto& texel = texels[static_cast<std::size_t>(random.next(0, 1) *
                                                      static_cast<float>(texels.size() - 1))];
        (place == Place::kRadiance ? texel.g : texel.density) = value;
    }
    all->environment->sky = std::move(sky);
    return all;
}

struct Traced {
    std::vector<DirectSample> samples;
    std::size_t seen = 0;  ///< samples that see light themselves
    std::size_t rejected = 0, rejected_radiance = 0;
    bool finite = true;
};

Traced trace(const Scene& scene, const TracedScene& traced) {
    const TextureTable textures{scene.textures, {}};
    const TraceInput input{&traced, &textures, {91, Stream::kTest}, 4, SurfaceChoice::kAll, {}};
    Traced all;
    std::vector<BatchSample> samples(kBatchSamples);
    std::vector<Rgbf> radiance(samples.size());
    BatchOutput out;
    for (std::uint32_t batch = 0; batch < 40; ++batch) {
        for (std::uint32_t i = 0; i < kBatchSamples; ++i)
            samples[i].camera = {i % 256, batch, i / 256};
        trace_batch(input, samples, out);
        all.rejected += out.rejected;
        for (DirectSample d : out.direct_samples) {
            d.sample += static_cast<int>(batch) * kBatchSamples;
            all.samples.push_back(d);
            all.finite = all.finite && is_finite(d.value) && is_finite(d.record.radiance_over_pdf);
        }
        for (const Rgbf& e : out.emitted) {
            all.finite = all.finite && is_finite(e);
            all.seen += !is_black(e);
        }
        all.rejected_radiance += trace_radiance(input, samples, radiance);
        for (const Rgbf& r : radiance) all.finite = all.finite && is_finite(r);
    }
    return all;
}

/// Whether `part` is what is left of `all`, in order and with the same bits.
bool is_part(const std::vector<DirectSample>& part, const std::vector<DirectSample>& all) {
    std::size_t k = 0;
    for (const DirectSample& d : all)
        if (k < part.size() && part[k].sample == d.sample && part[k].record == d.record) ++k;
    return k == part.size();
}

TEST(NonFiniteTrace, EachSampleIsKeptOrCounted) {
    const Scene scene = make_scene(false);
    const TracedScene whole = prepare(scene);
    const Traced clean = trace(scene, whole);
    ASSERT_EQ(clean.rejected, 0u);
    ASSERT_GT(clean.samples.size(), 20000u);
    for (const Place place : {Place::kRadiance, Place::kDensity})
        for (const float value : {kNan, kInfinity})
            for (const double rate : {1e-6, 1e-4, 1e-2}) {
                TracedScene traced = whole;
                traced.lights = spoiled(*whole.lights, place, rate, value);
                const Traced left = trace(scene, traced);
                const std::string what = "rate " + std::to_string(rate);
                EXPECT_TRUE(left.finite) << what;
                EXPECT_TRUE(is_part(left.samples, clean.samples)) << what;
                EXPECT_EQ(left.rejected, left.rejected_radiance) << what;
                EXPECT_EQ(left.rejected + left.samples.size() + left.seen,
                          clean.samples.size() + clean.seen)
                    << what;
                EXPECT_TRUE(rate < 1e-5 || left.samples.size() < clean.samples.size()) << what;
            }
}

TEST(NonFiniteTrace, PathsThatBounceAreKeptOrCounted) {
    const Scene scene = make_scene(true);
    const TracedScene whole = prepare(scene);
    const Traced clean = trace(scene, whole);
    ASSERT_EQ(clean.rejected, 0u);
    for (const Place place : {Place::kRadiance, Place::kDensity})
        for (const float value : {kNan, kInfinity})
            for (const double rate : {1e-4, 1e-2}) {
                TracedScene traced = whole;
                traced.lights = spoiled(*whole.lights, place, rate, value);
                const Traced left = trace(scene, traced);
                EXPECT_TRUE(left.finite) << rate;
                EXPECT_GT(left.rejected_radiance, 0u) << rate;
                EXPECT_GE(left.rejected, left.rejected_radiance) << rate;
            }
}

/// Paths are black or not finite from the second point on, and see no light before.
TEST(NonFiniteTrace, EachPathOfAThroughputThatIsNotFiniteIsCounted) {
    for (int channel = 0; channel < 3; ++channel)
        for (const float value : {kNan, kInfinity}) {
            Diffuse diffuse;
            diffuse.reflectance.constant = {0.5f, 0.5f, 0.5f};
            diffuse.reflectance.constant[channel] = value;
            Scene scene = test::make_small_scene();
            scene.bsdfs = {diffuse};
            scene.materials = {{"floor", {0}, {0}}};
            const auto quad = [](float z) {
                return test::make_quad({-100, -100, z}, {200, 0, 0}, {0, 200, 0});
            };
            scene.shapes = {{"floor", quad(0), {0}, {}}, {"below", quad(-1), {0}, {}}};
            scene.emitters = {PointEmitter{{0, 0, -2}, {1, 1, 1}}};
            scene.max_depth = 4, scene.rr_depth = 1;
            const Traced traced = trace(scene, prepare(scene));
            const auto samples = std::size_t{40} * kBatchSamples;
            EXPECT_EQ(traced.rejected, samples) << channel << ", " << value;
            EXPECT_EQ(traced.rejected_radiance, samples) << channel << ", " << value;
        }
}

}  // namespace
}  // namespace burnish
