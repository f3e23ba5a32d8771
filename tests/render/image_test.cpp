// Images of the conformance scenes and of the published scenes agree with the reference in every
// 8 x 8 tile and channel. Seeded defects are injected through the scene's data.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "burnish/error.h"
#include "csv.h"
#include "ledger_entries.h"
#include "mitsuba/load.h"
#include "render/reference_images.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;
using test::Batches;

using test::LedgerEntry;
using test::ledger::kAlpha;
using test::ledger::kConformance;
using test::ledger::kOtherScenes;
using test::ledger::kPublishedImages;

constexpr double kMeanTolerance = 0.003;

/// 64 batches, of this many samples per pixel.
Batches batches_of(const LedgerEntry& entry, std::uint32_t samples_per_pixel) {
    return {test::seed_of(entry), test::scaled(entry, 64u), samples_per_pixel};
}
Batches batches_of(const LedgerEntry& entry) {
    return batches_of(entry, entry.name == kPublishedImages.name ? 4 : 16);
}

/// How an image agrees with its reference: the p-value, and where it agrees least.
struct Agreement {
    double p_value = 0;
    std::string text;
};

test::TileComparison compare(const Scene& scene, const test::ReferenceImage& reference,
                             const Batches& batches, test::MeanDifference* mean = nullptr) {
    const auto ours = test::render_batches(scene, batches);
    const auto theirs = test::tile_means(reference, scene.film.filter);
    if (mean) *mean = test::image_mean_difference(ours.tiles, theirs);
    EXPECT_EQ(ours.rejected, 0u);
    return test::compare_tiles(ours.tiles, theirs);
}

/// The means are compared, too.
Agreement agreement_of(const std::string& name, const Scene& scene,
                       const test::ReferenceImage& reference, const LedgerEntry& entry) {
    EXPECT_EQ(reference.mean.width, scene.film.crop_width) << name;
    EXPECT_EQ(reference.mean.height, scene.film.crop_height) << name;
    if (testing::Test::HasFailure()) return {};
    test::MeanDifference mean;
    const auto c = compare(scene, reference, batches_of(entry), &mean);
    EXPECT_LT(mean.relative, kMeanTolerance + 5 * mean.standard_error) << name;
    return {c.p_value, fmt::format("{}, tile {}, channel {}: {} +- {}, expected {} +- {}", name,
                                   c.worst / 3, c.worst % 3, c.ours.mean, c.ours.standard_error,
                                   c.theirs.mean, c.theirs.standard_error)};
}

void expect_agreement(const std::string& name, const Scene& scene,
                      const test::ReferenceImage& reference, const LedgerEntry& entry) {
    const Agreement a = agreement_of(name, scene, reference, entry);
    EXPECT_TRUE(accepted(entry, name, a.p_value)) << a.text;
}

/// The scenes of tests/data.
const char* const kScenes[] = {"blend",
                               "bumpmap",
                               "checkerboard",
                               "conductor_mirror",
                               "constant_and_area",
                               "cornell_path",
                               "dielectrics",
                               "diffuse_area",
                               "diffuse_point",
                               "film_crop",
                               "filter_box",
                               "filter_catmullrom",
                               "filter_gaussian",
                               "filter_lanczos",
                               "filter_mitchell",
                               "filter_tent",
                               "focal_length",
                               "hidden_emitters_alpha",
                               "instances",
                               "language",
                               "legacy_0_5",
                               "many_lights",
                               "mask",
                               "mesh_emitter",
                               "mesh_normals",
                               "normalmap",
                               "one_sided_black_back",
                               "orthographic",
                               "plastics",
                               "principal_point",
                               "principled_glass",
                               "principled_lobes_area",
                               "principled_lobes_env",
                               "principled_textures",
                               "room_0_6",
                               "roughconductor",
                               "shapes",
                               "spot_directional",
                               "texture_orientation",
                               "textured_emitter",
                               "thinlens",
                               "twosided_two_faces",
                               "vertex_colors"};

class ConformanceImage : public testing::TestWithParam<const char*> {};

TEST_P(ConformanceImage, AgreesWithTheReference) {
    const fs::path folder = test::reference_folder() / "scenes";
    const std::string name = GetParam();
    const Scene scene = load_scene(folder / (name + ".xml")).scene;
    expect_agreement(name, scene, test::read_reference_image(folder, name), kConformance);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ConformanceImage, testing::ValuesIn(kScenes),
                         [](const auto& test) { return std::string(test.param); });

bool is_listed(const std::string& name) {
    return std::find(std::begin(kScenes), std::end(kScenes), name) != std::end(kScenes);
}

/// Scenes beyond the list: those that use what is not supported yet say so, the others must agree.
TEST(ConformanceImages, SceneOfTheFolderThatLoadsAgreesToo) {
    const fs::path folder = test::reference_folder() / "scenes";
    std::vector<fs::path> others;
    for (const auto& file : fs::directory_iterator(folder))
        if (file.path().extension() == ".xml" && !is_listed(file.path().stem().string()))
            others.push_back(file.path());
    std::vector<double> p;
    std::string texts;
    for (const fs::path& file : others) {
        const std::string name = file.stem().string();
        try {
            const Scene scene = load_scene(file).scene;
            const Agreement a =
                agreement_of(name, scene, test::read_reference_image(folder, name), kOtherScenes);
            p.push_back(a.p_value);
            texts += a.text + "\n";
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("not supported"), std::string::npos)
                << error.what();
        }
    }
    if (p.empty()) GTEST_SKIP() << "no scene beyond the list: see docs/testing.md";
    EXPECT_TRUE(accepted(kOtherScenes, "scenes beyond the list", test::holm_minimum(p))) << texts;
}

// ---- Alpha

test::TileMeans alpha_of(const Scene& scene, const Batches& batches) {
    const TracedScene traced = prepare(scene);
    const TextureTable textures{scene.textures, {}};
    std::vector<test::RunningMean> tiles;
    for (std::uint32_t b = 0; b < batches.count; ++b) {
        const TraceInput input{&traced,
                               &textures,
                               {batches.seed + b, Stream::kTest},
                               batches.samples_per_pixel,
                               SurfaceChoice::kAll,
                               {}};
        const auto averages =
            test::tile_averages(with_channels(render_alpha(input, batches.samples_per_pixel), 3));
        tiles.resize(averages.size());
        for (std::size_t i = 0; i < averages.size(); ++i) tiles[i].add(averages[i]);
    }
    test::TileMeans means;
    for (const test::RunningMean& t : tiles) means.tiles.push_back(test::estimate_of(t));
    return means;
}

double alpha_p_value(const Scene& scene) {
    const fs::path folder = test::reference_folder() / "scenes";
    const auto alpha = [&](const char* name) {
        return with_channels(read_image_file(folder / name).alpha, 3);
    };
    const test::ReferenceImage reference{alpha("hidden_emitters_alpha.exr"),
                                         alpha("hidden_emitters_alpha_stderr.exr")};
    return test::compare_tiles(alpha_of(scene, batches_of(kAlpha, 16)),
                               test::tile_means(reference, scene.film.filter))
        .p_value;
}

TEST(Alpha, AgreesWithTheReference) {
    Scene scene = load_scene(test::reference_folder() / "scenes/hidden_emitters_alpha.xml").scene;
    EXPECT_EQ(scene.film.pixel_format, PixelFormat::kRgba);
    EXPECT_TRUE(accepted(kAlpha, "hidden emitters", alpha_p_value(scene)));
    std::get<Sphere>(scene.shapes[0].geometry).radius *= 1.02f;
    EXPECT_TRUE(rejected(kAlpha, "sphere 2 % larger", alpha_p_value(scene)));
}

TEST(Alpha, OfAnEnvironmentThatIsSeenIsOne) {
    Scene scene = load_scene(test::reference_folder() / "scenes/hidden_emitters_alpha.xml").scene;
    scene.hide_emitters = false;
    scene.direct_alpha = false;
    const test::TileMeans means = alpha_of(scene, {1, 1, 4});
    for (const test::MeanEstimate& tile : means.tiles) EXPECT_NEAR(tile.mean, 1, 1e-5);
}

TEST(Alpha, OfDirectIsThatOfSurfacesAlone) {
    Scene scene = load_scene(test::reference_folder() / "scenes/hidden_emitters_alpha.xml").scene;
    const test::TileMeans hidden = alpha_of(scene, {1, 1, 4});
    scene.hide_emitters = false;
    const test::TileMeans seen = alpha_of(scene, {1, 1, 4});
    ASSERT_EQ(seen.tiles.size(), hidden.tiles.size());
    for (std::size_t i = 0; i < seen.tiles.size(); ++i)
        EXPECT_EQ(seen.tiles[i].mean, hidden.tiles[i].mean);
}

// ---- Seeded defects

Scene load_reference(const std::string& name) {
    return load_scene(test::reference_folder() / "scenes" / (name + ".xml")).scene;
}

double defect_p_value(const std::string& name, const Scene& scene) {
    return compare(scene, test::read_reference_image(test::reference_folder() / "scenes", name),
                   batches_of(kConformance))
        .p_value;
}

TEST(ConformanceImageDefect, LightTooBright) {
    Scene scene = load_reference("diffuse_point");
    for (Emitter& emitter : scene.emitters)
        if (auto* point = std::get_if<PointEmitter>(&emitter)) point->intensity *= 1.015f;
    EXPECT_TRUE(
        rejected(kConformance, "light 1.5 % brighter", defect_p_value("diffuse_point", scene)));
}

TEST(ConformanceImageDefect, FieldOfViewTooWide) {
    Scene scene = load_reference("filter_gaussian");
    scene.camera.fov_x *= 1.01;
    EXPECT_TRUE(rejected(kConformance, "field of view 1 % wider",
                         defect_p_value("filter_gaussian", scene)));
}

TEST(ConformanceImageDefect, TextureUpsideDown) {
    Scene scene = load_reference("texture_orientation");
    for (Texture& texture : scene.textures)
        if (auto* bitmap = std::get_if<Bitmap>(&texture)) {
            UvTransform& t = bitmap->to_uv;  // v' = 1 - v
            for (std::size_t i = 3; i < 6; ++i) t.m[i] = -t.m[i];
            t.m[5] += 1;
        }
    EXPECT_TRUE(rejected(kConformance, "texture upside down",
                         defect_p_value("texture_orientation", scene)));
}

TEST(ConformanceImageDefect, MaterialTooRough) {
    Scene scene = load_reference("principled_lobes_area");
    for (Bsdf& bsdf : scene.bsdfs)
        if (auto* principled = std::get_if<Principled>(&bsdf))
            (*principled)[PrincipledScalar::kRoughness].constant *= 1.1f;
    EXPECT_TRUE(rejected(kConformance, "roughness 10 % larger",
                         defect_p_value("principled_lobes_area", scene)));
}

TEST(ConformanceImageDefect, SkyTurned) {
    Scene scene = load_reference("principled_lobes_env");
    for (Emitter& emitter : scene.emitters)
        if (auto* sky = std::get_if<EnvironmentEmitter>(&emitter))
            sky->to_world = sky->to_world * rotation({0, 1, 0}, 3);
    EXPECT_TRUE(rejected(kConformance, "sky turned by 3 degrees",
                         defect_p_value("principled_lobes_env", scene)));
}

TEST(ConformanceImageDefect, BumpsTooHigh) {
    Scene scene = load_reference("bumpmap");
    for (Material& material : scene.materials)
        if (material.normals) *material.normals->height_scale *= 1.1f;
    EXPECT_TRUE(rejected(kConformance, "bumps 10 % higher", defect_p_value("bumpmap", scene)));
}

// ---- The published scenes

struct PublishedScene {
    const char* name;
    const char* parameter;  ///< the texture that the paper optimises
};
const PublishedScene kPublishedScenes[] = {
    {"chalice", "mat-chalice.brdf_0.roughness.data"},
    {"tire", "mat-tire.brdf_0.roughness.data"},
    {"ashtray", "mat-ashtray.brdf_0.anisotropic.data"},
};

class PublishedImage : public testing::TestWithParam<PublishedScene> {};

void set_texture(Scene& scene, const std::string& parameter, float value) {
    for (const Parameter& p : scene.parameters) {
        if (p.name != parameter) continue;
        auto& bitmap = std::get<Bitmap>(scene.textures[static_cast<std::size_t>(p.texture.value)]);
        bitmap.codes.clear();
        bitmap.values.assign(static_cast<std::size_t>(bitmap.width) *
                                 static_cast<std::size_t>(bitmap.height) *
                                 static_cast<std::size_t>(bitmap.channels),
                             value);
        return;
    }
    FAIL() << "no parameter " << parameter;
}

TEST_P(PublishedImage, AgreesWithTheReference) {
    const char* given = std::getenv("BURNISH_PAPER_DIR");
    if (!given) GTEST_SKIP() << "BURNISH_PAPER_DIR is not set: see docs/testing.md";
    const fs::path paper = given;
    const std::string name = GetParam().name;
    LoadOptions options;
    options.definitions = {{"integrator", "direct"}};
    options.width = options.height = 256;
    Scene scene = load_scene(paper / "scenes/paper" / name / "scene.xml", options).scene;
    const fs::path images = paper / "reference/paper";
    expect_agreement(name, scene, test::read_reference_image(images, name), kPublishedImages);
    set_texture(scene, GetParam().parameter, 0.5f);
    expect_agreement(name + "_half", scene, test::read_reference_image(images, name + "_half"),
                     kPublishedImages);
}

INSTANTIATE_TEST_SUITE_P(Paper, PublishedImage, testing::ValuesIn(kPublishedScenes),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace burnish
