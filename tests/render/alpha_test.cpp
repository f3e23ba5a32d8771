// Alpha: the share of surfaces. What masks and panes let through counts as what is behind.
#include <gtest/gtest.h>

#include "gradient/blends.h"
#include "render/render.h"
#include "shading/fresnel.h"

namespace burnish {
namespace {

/// A floor that fills the picture, of the material; under no sky.
Scene floor_scene() {
    Scene scene = test::make_small_scene();
    scene.shapes.resize(1);
    scene.shapes[0].geometry = test::make_quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0});
    scene.emitters = {PointEmitter{{0, 0, 3}, {5, 5, 5}}};
    scene.camera.to_world = look_at({0, 0, 3}, {0, 0, 0}, {0, 1, 0});
    scene.film.filter = {FilterKind::kBox, 0.5f};
    scene.max_depth = 8;
    scene.direct_alpha = false;
    return scene;
}

double mean_alpha(const Scene& scene) {
    const TracedScene traced = prepare(scene);
    const TextureTable textures{scene.textures, {}};
    const TraceInput input{&traced, &textures, {81, Stream::kImage}, 16, SurfaceChoice::kAll, {}};
    const Image alpha = render_alpha(input, 16);
    double sum = 0;
    for (const float a : alpha.values) sum += double{a};
    return sum / static_cast<double>(alpha.values.size());
}

/// The floor becomes a mask of this opacity.
void mask(Scene& scene, float opacity) {
    const MaterialId floor = test::add_material(scene, {0});
    const BsdfId pane = test::add_bsdf(scene, Dielectric{{kWhite, kWhite}, 1, true});
    const MaterialId nothing = test::add_material(scene, pane, false);
    scene.materials[0].blend = MaterialBlend{{opacity, {}}, nothing, floor};
}

TEST(Alpha, OfAMaskIsItsOpacity) {
    Scene scene = floor_scene();
    EXPECT_EQ(mean_alpha(scene), 1);
    mask(scene, 0.25f);
    EXPECT_NEAR(mean_alpha(scene), 0.25, 4 * std::sqrt(0.25 * 0.75 / (256 * 16)));
    scene.max_depth = 2;
    EXPECT_NEAR(mean_alpha(scene), 0.25, 4 * std::sqrt(0.25 * 0.75 / (256 * 16)));
    // Mitsuba's `direct` knows nothing behind it.
    scene.direct_alpha = true;
    EXPECT_EQ(mean_alpha(scene), 1);
}

/// As in Mitsuba.
TEST(Alpha, OfAnEnvironmentIsOneButWithDirect) {
    Scene scene = floor_scene();
    scene.emitters = {ConstantEmitter{}};
    scene.camera.to_world = look_at({0, 0, 3}, {0, 0, 6}, {0, 1, 0});
    EXPECT_EQ(mean_alpha(scene), 1);
    scene.hide_emitters = true;
    EXPECT_EQ(mean_alpha(scene), 0);
    scene.hide_emitters = false;
    scene.direct_alpha = true;
    EXPECT_EQ(mean_alpha(scene), 0);
}

/// As in Mitsuba: a surface counts where a path goes on from it.
TEST(Alpha, EndsWherePathsDo) {
    Scene scene = floor_scene();
    mask(scene, 0.25f);
    scene.materials.push_back({"floor", {0}, {0}});
    scene.shapes.push_back(scene.shapes[0]);
    scene.shapes[1].geometry = test::make_quad({-9, -9, -1}, {18, 0, 0}, {0, 18, 0});
    scene.shapes[1].material = {static_cast<std::int32_t>(scene.materials.size()) - 1};
    scene.max_depth = 3;
    EXPECT_EQ(mean_alpha(scene), 1);
    scene.max_depth = 2;
    EXPECT_NEAR(mean_alpha(scene), 0.25, 4 * std::sqrt(0.25 * 0.75 / (256 * 16)));
    scene.max_depth = 1;
    EXPECT_EQ(mean_alpha(scene), 0);
    scene.max_depth = 0;
    EXPECT_EQ(mean_alpha(scene), 0);
    scene.emitters = {ConstantEmitter{}};
    EXPECT_EQ(mean_alpha(scene), 0);
    scene.max_depth = 1;
    EXPECT_EQ(mean_alpha(scene), 1) << "the sky";
}

/// The last segment of a path brings light, and so do those behind a mask.
TEST(Alpha, OfALampThatPathsEndOnIsOne) {
    Scene scene = floor_scene();
    AreaEmitter lamp;
    lamp.shape = {0};
    scene.emitters.push_back(lamp);
    scene.max_depth = 1;
    EXPECT_EQ(mean_alpha(scene), 1);
    scene.max_depth = 0;
    EXPECT_EQ(mean_alpha(scene), 0);

    mask(scene, 0.25f);
    scene.shapes.push_back(scene.shapes[0]);
    scene.shapes[1].geometry = test::make_quad({-9, -9, -1}, {18, 0, 0}, {0, 18, 0});
    std::get<AreaEmitter>(scene.emitters.back()).shape = {1};
    scene.max_depth = 2;
    EXPECT_EQ(mean_alpha(scene), 1);
    scene.max_depth = 1;
    EXPECT_EQ(mean_alpha(scene), 0);
}

/// A narrow filter leaves pixels without a sample.
TEST(Alpha, OfAPixelThatNoSampleReachesIsNone) {
    Scene scene = floor_scene();
    scene.film.filter = {FilterKind::kGaussian, 0.05f};
    const TracedScene traced = prepare(scene);
    const TextureTable textures{scene.textures, {}};
    const TraceInput input{&traced, &textures, {81, Stream::kImage}, 1, SurfaceChoice::kAll, {}};
    const Image alpha = render_alpha(input, 1);
    EXPECT_GT(std::count(alpha.values.begin(), alpha.values.end(), 0.0f), 0);
    for (const float a : alpha.values) EXPECT_TRUE(a == 0 || a == 1) << a;
}

TEST(Alpha, BehindAMaskIsThatOfWhatIsThere) {
    Scene scene = floor_scene();
    mask(scene, 0.25f);
    scene.shapes.push_back(scene.shapes[0]);
    scene.shapes[1].geometry = test::make_quad({-9, -9, -1}, {18, 0, 0}, {0, 18, 0});
    const double both = 1 - 0.75 * 0.75;
    EXPECT_NEAR(mean_alpha(scene), both, 4 * std::sqrt(both * (1 - both) / (256 * 16)));
    scene.materials.push_back({"floor", {0}, {0}});
    scene.shapes[1].material = {static_cast<std::int32_t>(scene.materials.size()) - 1};
    EXPECT_EQ(mean_alpha(scene), 1);
}

TEST(Alpha, OfAPaneIsWhatItMirrors) {
    Scene scene = floor_scene();
    scene.camera.fov_x = 0.1f;  // straight on
    const BsdfId pane = test::add_bsdf(scene, Dielectric{{kWhite, kWhite}, 1.5f, true});
    scene.materials[0] = {"pane", pane, {}};
    EXPECT_NEAR(mean_alpha(scene), 2 * 0.04 / 1.04, 1e-5);
}

/// What a pane of thin glass mirrors.
double mirrored(float cosine) {
    const double r = fresnel_dielectric(cosine, 1.5f).reflectance;
    return 2 * r / (1 + r);
}

/// The floor becomes a pane whose normals are all that one.
void lay_pane(Scene& scene, const Vec3f& normal) {
    const BsdfId pane = test::add_bsdf(scene, Dielectric{{kWhite, kWhite}, 1.5f, true});
    scene.materials[0] = {"pane", pane, {}};
    Bitmap texels;
    texels.width = texels.height = 2, texels.channels = 3;
    for (int i = 0; i < 4 * 3; ++i) texels.values.push_back((normal[i % 3] + 1) / 2);
    scene.textures.emplace_back(texels);
    scene.materials[0].normals =
        NormalMap{.texture = {static_cast<std::int32_t>(scene.textures.size()) - 1}};
}

TEST(Alpha, OfAPaneWithAMapIsWhatItsTurnedNormalMirrors) {
    for (const float cosine : {1.0f, 0.6f, 0.3f}) {
        Scene scene = floor_scene();
        scene.camera.fov_x = 0.1f;  // straight on
        lay_pane(scene, {std::sqrt(1 - cosine * cosine), 0, cosine});
        EXPECT_NEAR(mean_alpha(scene), mirrored(cosine), 1e-3) << cosine;
    }
    EXPECT_GT(mirrored(0.3f), mirrored(1.0f) + 0.2);
}

TEST(Alpha, OfAPaneWithHeightsIsWhatItsTurnedNormalMirrors) {
    Scene scene = floor_scene();
    scene.camera.fov_x = 0.1f;
    lay_pane(scene, {0, 0, 1});
    Bitmap slope;  // from 0 to 1 in half of the floor, which is 18 wide
    slope.width = slope.height = 2, slope.channels = 1;
    slope.values = {0, 1, 0, 1};
    scene.textures.back() = slope;
    scene.materials[0].normals->height_scale = 18;
    EXPECT_NEAR(mean_alpha(scene), mirrored(1 / std::sqrt(5.0f)), 1e-3);
}

/// As in Mitsuba: where a map leaves nothing of what goes straight on, the path ends there.
TEST(Alpha, EndsWhereAMapLeavesNoLightThatPasses) {
    Scene scene = floor_scene();
    scene.camera.fov_x = 0.1f;
    scene.camera.to_world = look_at({3, 0, 1}, {0, 0, 0}, {0, 1, 0});
    lay_pane(scene, {-0.6f, 0, 0.8f});
    scene.materials.push_back({"floor", {0}, {0}});
    scene.shapes.push_back(scene.shapes[0]);
    scene.shapes[1].geometry = test::make_quad({-9, -9, -1}, {18, 0, 0}, {0, 18, 0});
    scene.shapes[1].material = {static_cast<std::int32_t>(scene.materials.size()) - 1};
    EXPECT_EQ(mean_alpha(scene), 1) << "the normal is turned to the camera";
    scene.materials[0].normals->flip_invalid = false;
    EXPECT_NEAR(mean_alpha(scene), mirrored(1 / std::sqrt(10.0f)), 1e-3);
}

}  // namespace
}  // namespace burnish
