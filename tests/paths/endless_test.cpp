// Paths that nothing but themselves could end: in a closed room, whatever the integrator's depths;
// and paths of negative light.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "gradient/binding.h"
#include "gradient/small_scene.h"
#include "paths/trace.h"

namespace burnish {
namespace {

/// A box around the camera, alike on all sides, without an end to paths.
Scene closed_box(const ColorInput& reflectance, int rr_depth) {
    Scene scene = test::make_small_scene();
    scene.bsdfs = {Diffuse{reflectance}};
    scene.materials = {{"wall", {0}, {0}}};
    scene.shapes.clear();
    const auto add = [&](const Vec3f& corner, const Vec3f& u, const Vec3f& v) {
        scene.shapes.push_back({"wall", test::make_quad(corner, u, v), {0}, {}});
    };
    for (const float side : {-5.0f, 5.0f}) {
        add({side, -5, -5}, {0, 10, 0}, {0, 0, 10});
        add({-5, side, -5}, {10, 0, 0}, {0, 0, 10});
        add({-5, -5, side}, {10, 0, 0}, {0, 10, 0});
    }
    scene.emitters = {PointEmitter{{0, 0, 3}, {5, 5, 5}}};
    scene.max_depth = std::numeric_limits<int>::max();
    scene.rr_depth = rr_depth;
    return scene;
}

struct Ended {
    std::size_t rejected = 0, rejected_radiance = 0;
};

Ended trace(const Scene& scene) {
    const TracedScene traced = prepare(scene);
    const Theta theta = test::theta_of(scene);
    const Binding binding(traced, theta);
    TraceInput input = unknown_derivatives(binding, {92, Stream::kTest}, 1);
    input.choice = SurfaceChoice::kAll;
    std::vector<BatchSample> samples(256);
    for (std::uint32_t i = 0; i < samples.size(); ++i) samples[i].camera = {i, 0, 0};
    std::vector<Rgbf> radiance(samples.size());
    BatchOutput out;
    trace_batch(input, samples, out);
    return {out.rejected, trace_radiance(input, samples, radiance)};
}

TEST(EndlessPaths, EndWhateverTheDepthOfRussianRoulette) {
    const ColorInput white{{1, 1, 1}, {}}, gray{{0.5f, 0.5f, 0.5f}, {}}, black{{0, 0, 0}, {}};
    for (const ColorInput& reflectance : {white, gray, black, ColorInput{{}, {0}}}) {
        const Ended ended = trace(closed_box(reflectance, std::numeric_limits<int>::max()));
        EXPECT_EQ(ended.rejected, 0u);
        EXPECT_EQ(ended.rejected_radiance, 0u);
    }
}

TEST(EndlessPaths, EndWhereTheyAreNotFiniteAndAreCounted) {
    const Ended ended = trace(closed_box({{1e20f, 0, 1e20f}, {}}, 5));
    EXPECT_EQ(ended.rejected_radiance, 256u);
}

/// What a floor under an even sky sends to each pixel, or that sky itself. All paths may end at
/// their first point.
std::vector<Rgbf> light_from_floor(float reflectance) {
    Scene scene = test::make_small_scene();
    scene.bsdfs[0] = Diffuse{ColorInput{{reflectance, reflectance, reflectance}, {}}};
    scene.shapes.resize(1);
    scene.emitters = {ConstantEmitter{{1, 1, 1}}};
    scene.max_depth = 5, scene.rr_depth = 1;
    const TracedScene traced = prepare(scene);
    const TextureTable textures{scene.textures, {}};
    const TraceInput input{&traced, &textures, {93, Stream::kTest}, 1, SurfaceChoice::kAll, {}};
    std::vector<BatchSample> samples(256);
    for (std::uint32_t i = 0; i < samples.size(); ++i) samples[i].camera = {i, 0, 0};
    std::vector<Rgbf> radiance(samples.size());
    trace_radiance(input, samples, radiance);
    return radiance;
}

TEST(EndlessPaths, NegativeLightEndsAsOftenAsPositive) {
    const std::vector<Rgbf> light = light_from_floor(0.5f), negative = light_from_floor(-0.5f);
    int from_floor = 0;
    for (std::size_t i = 0; i < light.size(); ++i) {
        EXPECT_EQ(std::abs(negative[i].x), light[i].x);
        from_floor += negative[i].x < 0;
    }
    EXPECT_GT(from_floor, 50);
}

}  // namespace
}  // namespace burnish
