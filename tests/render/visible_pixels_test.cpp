// Which pixels can see a BSDF: no primary ray that meets one may start in an unmarked pixel, and
// what is far from it stays unmarked. The seeded defect, a projection shifted by a pixel, is found.
#include "render/visible_pixels.h"

#include <gtest/gtest.h>

#include "gradient/small_scene.h"
#include "paths/trace.h"

namespace burnish {
namespace {

Scene framed_scene() {
    Scene scene = test::make_small_scene();
    scene.film = {90, 70, 11, 7, 61, 52, {FilterKind::kGaussian, 2}};
    scene.camera.principal_offset_x = 0.07;
    scene.camera.principal_offset_y = -0.03;
    return scene;
}

/// Draws on the given BSDFs that start in unmarked pixels; `seen` counts all.
std::size_t missed(const Scene& scene, const std::vector<char>& bsdfs,
                   const std::vector<char>& marks, std::size_t& seen) {
    const TracedScene traced = prepare(scene);
    const TextureTable textures{scene.textures, {}};
    const TraceInput input{&traced, &textures, {41, Stream::kTest}, 1, SurfaceChoice::kUnknown,
                           bsdfs};
    std::size_t count = 0;
    BatchOutput out;
    for (std::uint32_t pass = 0; pass < 64; ++pass)
        for (std::uint32_t pixel = 0; pixel < marks.size(); pixel += 64) {
            std::vector<BatchSample> samples;
            for (std::uint32_t i = pixel; i < std::min<std::size_t>(pixel + 64, marks.size()); ++i)
                samples.push_back({{i, pass, 0}});
            trace_batch(input, samples, out);
            for (const DirectSample& d : out.direct_samples)
                ++seen, count += !marks[d.record.pixel];
        }
    return count;
}

std::vector<char> shifted(const std::vector<char>& marks, int width) {
    std::vector<char> result(marks.size(), 0);
    for (std::size_t i = 0; i + 1 < marks.size(); ++i)
        if ((i + 1) % static_cast<std::size_t>(width)) result[i + 1] = marks[i];
    return result;
}

TEST(VisiblePixels, NoRayMeetsTheBsdfElsewhere) {
    const Scene scene = framed_scene();
    const std::vector<char> bsdfs{1, 0}, marks = visible_pixels(prepare(scene), bsdfs);
    EXPECT_EQ(pixels_of(scene.film), 61 * 52);
    EXPECT_EQ(marks.size(), 61u * 52u);
    std::size_t seen = 0;
    EXPECT_EQ(missed(scene, bsdfs, marks, seen), 0u);
    EXPECT_GT(seen, 10000u);
    EXPECT_GT(missed(scene, bsdfs, shifted(marks, scene.film.crop_width), seen), 0u)
        << "a shifted projection must be noticed";
}

TEST(VisiblePixels, OfAnOrthographicCamera) {
    Scene scene = framed_scene();
    scene.camera.orthographic_width = 2.5;
    scene.camera.near_clip = 0.5f;
    const std::vector<char> bsdfs{1, 0}, marks = visible_pixels(prepare(scene), bsdfs);
    std::size_t seen = 0;
    EXPECT_EQ(missed(scene, bsdfs, marks, seen), 0u);
    EXPECT_GT(seen, 10000u);
    EXPECT_GT(missed(scene, bsdfs, shifted(marks, scene.film.crop_width), seen), 0u);
}

TEST(VisiblePixels, OfInstancesAndCylinders) {
    Scene scene = framed_scene();
    Cylinder cylinder;
    cylinder.to_world = translation({0.1, 0.2, 0.1}) * scaling({0.2, 0.2, 0.4});
    cylinder.to_local = inverse(cylinder.to_world);
    const MaterialId material = scene.shapes[0].material;
    scene.prototypes = {
        {"p", test::make_quad({0, 0, 0}, {0.5f, 0, 0}, {0, 0.3f, 0.1f}), material, {}}};
    const Transform moved = translation({-0.4, 0.1, 0.4}) * rotation({0, 0, 1}, 30);
    scene.shapes[0] = {"c", cylinder, material, {}};
    scene.shapes.push_back({"i", Instance{0, moved, inverse(moved)}, material, {}});
    const std::vector<char> bsdfs{1, 0}, marks = visible_pixels(prepare(scene), bsdfs);
    std::size_t seen = 0;
    EXPECT_EQ(missed(scene, bsdfs, marks, seen), 0u);
    EXPECT_GT(seen, 1000u);
    EXPECT_LT(std::count(marks.begin(), marks.end(), 1), 61 * 52);
}

TEST(VisiblePixels, FollowTheOutlineOfATriangle) {
    Scene scene = framed_scene();
    const auto count = [](const std::vector<char>& marks) {
        return std::count(marks.begin(), marks.end(), 1);
    };
    const auto all = static_cast<std::ptrdiff_t>(61 * 52);
    EXPECT_LT(count(visible_pixels(prepare(scene), std::vector<char>{1, 0})), all);
    scene.shapes.resize(1);
    scene.emitters = {ConstantEmitter{{1, 1, 1}}};
    std::get<Mesh>(scene.shapes[0].geometry).triangles.resize(1);  // half of the floor
    const std::vector<char> half = visible_pixels(prepare(scene), std::vector<char>{1, 0});
    std::size_t seen = 0;
    EXPECT_EQ(missed(scene, {1, 0}, half, seen), 0u);
    EXPECT_LT(static_cast<double>(count(half)),
              0.7 * static_cast<double>(
                        count(visible_pixels(prepare(framed_scene()), std::vector<char>{1, 0}))));
}

TEST(VisiblePixels, ASurfaceAroundTheCameraIsSeenEverywhere) {
    Scene scene = framed_scene();
    scene.shapes.resize(1);
    scene.emitters = {ConstantEmitter{{1, 1, 1}}};
    scene.shapes[0].geometry = test::make_quad({-50, -50, 1.79f}, {100, 0, 0}, {0, 100, 0});
    const std::vector<char> marks = visible_pixels(prepare(scene), std::vector<char>{1, 0});
    std::size_t seen = 0;
    EXPECT_EQ(missed(scene, {1, 0}, marks, seen), 0u);
    EXPECT_EQ(std::count(marks.begin(), marks.end(), 1), 61 * 52);
}

TEST(VisiblePixels, DilationReachesBothWays) {
    std::vector<char> one(7 * 5, 0);
    one[2 * 7 + 3] = 1;
    const std::vector<char> wide = dilate(one, 7, 5, 2);
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 7; ++x)
            EXPECT_EQ(wide[static_cast<std::size_t>(y * 7 + x)], x >= 1 && x <= 5 ? 1 : 0);
}

}  // namespace
}  // namespace burnish
