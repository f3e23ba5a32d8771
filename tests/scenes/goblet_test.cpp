// The procedural goblet: its files are complete, well formed, the same every time, and move with
// the seed.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "burnish/error.h"
#include "error_of.h"
#include "file_bytes.h"
#include "image/image.h"
#include "mitsuba/load.h"
#include "mitsuba/temporary_scene.h"
#include "scenes/goblet.h"
#include "scenes/procedural.h"
#include "scenes/scene_folder.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;

using test::contents;

TEST(Goblet, WritesTheSameBytesTwiceAndOthersForAnotherSeed) {
    const TemporaryFolder folder;
    write_procedural_scene("goblet", folder.path / "a", {64, 1});
    write_procedural_scene("goblet", folder.path / "b", {64, 1});
    write_procedural_scene("goblet", folder.path / "c", {64, 2});
    const auto first = contents(folder.path / "a"), again = contents(folder.path / "b"),
               other = contents(folder.path / "c");
    EXPECT_EQ(first.size(), 10u);
    EXPECT_EQ(first, again);
    for (const char* name : {"scene.xml", "textures/goblet_roughness.png", "textures/sky.exr"}) {
        ASSERT_TRUE(first.contains(name) && other.contains(name)) << name;
        EXPECT_NE(first.at(name), other.at(name)) << name << " does not depend on the seed";
    }
    EXPECT_EQ(first.at("meshes/goblet.ply"), other.at("meshes/goblet.ply"));
}

TEST(Goblet, RoughnessCoversItsRange) {
    const Image roughness = procedural::make_goblet_textures(256, 1).roughness;
    std::vector<float> sorted = roughness.values;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_GE(sorted.front(), 0.1f);
    EXPECT_LE(sorted.back(), 0.8f);
    // Content worth recovering: neither end dominates.
    EXPECT_LT(sorted[sorted.size() / 10], 0.2f);
    EXPECT_GT(sorted[9 * sorted.size() / 10], 0.5f);
}

TEST(Goblet, WallIsASmoothlyShadedUnwrappedSurface) {
    const Mesh wall = procedural::make_goblet_wall();
    EXPECT_GE(wall.triangles.size(), 20000u);
    EXPECT_LE(wall.triangles.size(), 80000u);
    // Every texel is used, kGobletRepeats times.
    EXPECT_NEAR(test::uv_area(wall), procedural::kGobletRepeats, 1e-3);
    EXPECT_GT(test::worst_normal(wall), 0.3) << "a normal turns away from its triangle";
}

TEST(Goblet, SceneLoadsWithoutWarnings) {
    const TemporaryFolder folder;
    write_procedural_scene("goblet", folder.path, {64, 1});
    LoadOptions options;
    options.definitions["resx"] = "32";
    options.definitions["resy"] = "24";
    const LoadedScene loaded = load_scene(folder.path / "scene.xml", options);
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
    EXPECT_EQ(loaded.scene.film.width, 32);
    EXPECT_EQ(loaded.scene.film.height, 24);
    EXPECT_GE(loaded.scene.emitters.size(), 25u);
    const auto& parameters = loaded.scene.parameters;
    const auto roughness = std::find_if(
        parameters.begin(), parameters.end(),
        [](const Parameter& p) { return p.name == "mat-goblet.brdf_0.roughness.data"; });
    ASSERT_NE(roughness, parameters.end());
    const auto& bitmap = std::get<Bitmap>(loaded.scene[roughness->texture]);
    EXPECT_TRUE(bitmap.raw);
    EXPECT_EQ(bitmap.filter, TextureFilter::kNearest);
    const Image truth = procedural::make_goblet_textures(64, 1).roughness,
                read = linear_image(bitmap);
    ASSERT_EQ(read.values.size(), truth.values.size());
    for (std::size_t i = 0; i < truth.values.size(); ++i) {
        ASSERT_NEAR(read.values[i], truth.values[i], 0.5f / 255 + 1e-6f) << "texel " << i;
    }
}

std::string message_of(const std::string& name, const fs::path& folder,
                       const ProceduralOptions& options) {
    return test::error_of<Error>([&] { write_procedural_scene(name, folder, options); });
}

TEST(Goblet, SaysWhatIsWrong) {
    const TemporaryFolder folder;
    EXPECT_EQ(message_of("cup", folder.path, {}),
              "no built-in scene is called 'cup', expected one of goblet, tyre, bowl, tree");
    EXPECT_EQ(message_of("gobblet", folder.path, {}),
              "no built-in scene is called 'gobblet', did you mean goblet? Expected one of "
              "goblet, tyre, bowl, tree");
    EXPECT_EQ(message_of("goblet", folder.path, {9000, 1}),
              "the texture size of a built-in scene is 9000, expected 16 to 8192");
    std::ofstream(folder.path / "file") << "not a folder";
    EXPECT_NE(message_of("goblet", folder.path / "file", {64, 1}).find("the folder cannot be made"),
              std::string::npos);
    EXPECT_THROW(write_procedural_scene("goblet", folder.path / "file", {64, 1}), OutputError);
    fs::create_directories(folder.path / "taken/scene.xml");
    EXPECT_THROW(write_procedural_scene("goblet", folder.path / "taken", {64, 1}), OutputError);
    EXPECT_NE(message_of("goblet", folder.path / "taken", {64, 1})
                  .find("scene.xml: cannot be written: Is a directory"),
              std::string::npos);
}

}  // namespace
}  // namespace burnish
