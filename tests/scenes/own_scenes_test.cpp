// All procedural scenes: complete, the same every time, moved by the seed, read without a warning,
// lit everywhere; and their textures have something to recover at every scale.
#include <gtest/gtest.h>

#include <cmath>

#include "file_bytes.h"
#include "mitsuba/load.h"
#include "mitsuba/temporary_scene.h"
#include "render/render.h"
#include "scenes/bowl.h"
#include "scenes/goblet.h"
#include "scenes/marks.h"
#include "scenes/procedural.h"
#include "scenes/scene_folder.h"
#include "scenes/tree.h"
#include "scenes/tyre.h"

namespace burnish {
namespace {

struct Expected {
    const char *name, *parameter, *texture;
    std::size_t min_emitters, max_emitters;
};

constexpr Expected kScenes[] = {
    {"goblet", "mat-goblet.brdf_0.roughness.data", "goblet_roughness", 25, 40},
    {"tyre", "mat-tyre.brdf_0.roughness.data", "tyre_roughness", 4, 6},
    {"bowl", "mat-bowl.brdf_0.anisotropic.data", "bowl_anisotropic", 2, 2},
    {"tree", "mat-tree.brdf_0.base_color.data", "tree_base_color", 200, 400},
};

class OwnScene : public testing::TestWithParam<Expected> {};

LoadedScene load_small(const std::filesystem::path& folder) {
    LoadOptions options;
    options.definitions["resx"] = options.definitions["resy"] = "24";
    return load_scene(folder / "scene.xml", options);
}

TEST_P(OwnScene, IsTheSameTwiceAndAnotherForAnotherSeed) {
    const TemporaryFolder folder;
    const std::string name = GetParam().name;
    write_procedural_scene(name, folder.path / "a", {64, 1});
    write_procedural_scene(name, folder.path / "b", {64, 1});
    write_procedural_scene(name, folder.path / "c", {64, 2});
    const auto first = test::contents(folder.path / "a"), other = test::contents(folder.path / "c");
    EXPECT_EQ(first, test::contents(folder.path / "b"));
    const std::string texture = std::string("textures/") + GetParam().texture + ".png";
    ASSERT_TRUE(first.contains(texture) && other.contains(texture));
    EXPECT_NE(first.at(texture), other.at(texture));
    ASSERT_TRUE(first.contains("LICENSE"));
    EXPECT_NE(first.at("LICENSE").find("SPDX-License-Identifier: Apache-2.0"), std::string::npos);
}

TEST_P(OwnScene, LoadsWithoutWarningsAndHasItsParameter) {
    const TemporaryFolder folder;
    write_procedural_scene(GetParam().name, folder.path, {64, 1});
    const LoadedScene loaded = load_small(folder.path);
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
    EXPECT_GE(loaded.scene.emitters.size(), GetParam().min_emitters);
    EXPECT_LE(loaded.scene.emitters.size(), GetParam().max_emitters);
    std::size_t triangles = 0;
    for (const Shape& shape : loaded.scene.shapes)
        if (const Mesh* mesh = std::get_if<Mesh>(&shape.geometry))
            triangles += mesh->triangles.size();
    EXPECT_GE(triangles, 20000u);
    EXPECT_LE(triangles, 200000u);
    const auto& parameters = loaded.scene.parameters;
    const auto parameter =
        std::find_if(parameters.begin(), parameters.end(),
                     [](const Parameter& p) { return p.name == GetParam().parameter; });
    ASSERT_NE(parameter, parameters.end());
    EXPECT_EQ(std::get<Bitmap>(loaded.scene[parameter->texture]).filter, TextureFilter::kNearest);
}

TEST_P(OwnScene, IsLitEverywhere) {
    const TemporaryFolder folder;
    write_procedural_scene(GetParam().name, folder.path, {64, 1});
    const LoadedScene loaded = load_small(folder.path);
    const TracedScene traced = prepare(loaded.scene);
    const TextureTable textures{loaded.scene.textures, {}};
    RenderCounts counts;
    constexpr std::uint32_t kPasses = 64;
    TraceInput input;
    input.scene = &traced;
    input.textures = &textures;
    input.key = {7, Stream::kTest};
    input.passes_per_iteration = kPasses;
    const Image image = render(input, 0, kPasses, &counts);
    EXPECT_EQ(counts.rejected, 0u);
    double sum = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const float brightest =
                std::max({image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)});
            EXPECT_GT(brightest, 1e-3f) << "pixel " << x << ", " << y << " is black";
            for (int c = 0; c < 3; ++c) sum += static_cast<double>(image.at(x, y, c));
        }
    }
    const double mean = sum / static_cast<double>(image.values.size());
    EXPECT_GT(mean, 0.1);
    EXPECT_LT(mean, 0.8);
}

INSTANTIATE_TEST_SUITE_P(All, OwnScene, testing::ValuesIn(kScenes),
                         [](const auto& scene) { return std::string(scene.param.name); });

TEST(OwnScenes, AreAllTested) {
    std::vector<std::string> tested;
    for (const Expected& scene : kScenes) tested.emplace_back(scene.name);
    EXPECT_EQ(procedural_scene_names(), tested);
}

/// Values within [least, most], and differences of at least 0.02 between neighbouring blocks of 1
/// to 64 texels.
void expect_content(const Image& image, float min, float max) {
    const auto [low, high] = std::minmax_element(image.values.begin(), image.values.end());
    EXPECT_GE(*low, min);
    EXPECT_LE(*high, max);
    EXPECT_GT(*high - *low, 0.6f);
    for (int block = 1; block <= 64; block *= 4)
        EXPECT_GT(test::contrast_at(image, block), 0.02) << "blocks of " << block;
}

TEST(OwnScenes, TexturesHaveContentAtEveryScale) {
    expect_content(procedural::make_tyre_textures(512, 1).roughness, 0.07f, 0.93f);
    expect_content(procedural::make_bowl_textures(512, 1).anisotropic, 0.06f, 0.94f);
    expect_content(procedural::make_tree_texture(512, 1), 0.05f, 0.95f);
}

TEST(OwnScenes, AFlatTextureHasNoContent) {
    EXPECT_LT(test::contrast_at(make_image(64, 64, 1, 0.5f), 4), 1e-12);
}

TEST(OwnScenes, TexturesArePaintedAtTheMiddlesOfTexels) {
    const Image painted = procedural::painted(2, [](float u, float v) { return Rgbf{u, v, 1}; });
    const std::vector<float> expected{0.25f, 0.25f, 1, 0.75f, 0.25f, 1,
                                      0.25f, 0.75f, 1, 0.75f, 0.75f, 1};
    EXPECT_EQ(painted.values, expected);
}

TEST(OwnScenes, SurfacesAreSmoothlyShaded) {
    EXPECT_GT(test::worst_normal(procedural::make_tyre()), 0.2);
    EXPECT_GT(test::worst_normal(procedural::make_wheel()), 0.2);
    EXPECT_GT(test::worst_normal(procedural::make_bowl()), 0.2);
    EXPECT_GT(test::worst_normal(procedural::make_tree(1)), 0.2);
    EXPECT_GT(test::worst_normal(procedural::make_ring_light()), 0.9);
    EXPECT_GT(test::worst_normal(procedural::make_bulb()), 0.999);
    EXPECT_GT(test::worst_normal(procedural::make_star()), 0.999);
    EXPECT_GT(test::worst_normal(procedural::make_lantern()), 0.3);
}

TEST(OwnScenes, EveryTexelIsOnTheSurface) {
    // Both halves of the tyre show the texture.
    EXPECT_NEAR(test::uv_area(procedural::make_tyre()), 2 * procedural::kTyreRepeats, 1e-3);
    EXPECT_NEAR(test::uv_area(procedural::make_bowl()), procedural::kBowlRepeats, 0.05);
}

}  // namespace
}  // namespace burnish
