// The conformance scenes and the published scenes load, without a word, into what they describe.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <sstream>

#include "mitsuba/temporary_scene.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> scene_files(const char* folder) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(fs::path(BURNISH_TEST_DATA) / folder))
        if (entry.path().extension() == ".xml") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
}

std::vector<std::string> parameter_names(const Scene& scene) {
    std::vector<std::string> names;
    for (const Parameter& parameter : scene.parameters) names.push_back(parameter.name);
    return names;
}

Vec3f geometric_normal(const Mesh& mesh, std::size_t triangle) {
    const auto corner = [&](std::size_t i) {
        return mesh.positions[mesh.triangles[triangle].vertex[i]];
    };
    return normalize(cross(corner(1) - corner(0), corner(2) - corner(0)));
}

void expect_near(const Vec3f& a, const Vec3f& b, float tolerance) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

LoadedScene load_reference(const std::string& name) {
    return load_scene(fs::path(BURNISH_TEST_DATA) / "scenes" / (name + ".xml"));
}

TEST(ReferenceScenes, LoadWithoutWarnings) {
    const std::vector<fs::path> files = scene_files("scenes");
    ASSERT_EQ(files.size(), 43u);
    for (const fs::path& file : files) {
        const LoadedScene loaded = load_scene(file);
        EXPECT_EQ(joined(loaded.warnings), "") << file;
        EXPECT_FALSE(loaded.scene.shapes.empty()) << file;
        EXPECT_FALSE(loaded.scene.emitters.empty()) << file;
        EXPECT_EQ(loaded.scene.sample_count, 64) << file;
    }
}

TEST(ReferenceScenes, GradientScenesLoadWithTheirParameters) {
    ASSERT_EQ(scene_files("gradients").size(), 4u);
    for (const fs::path& file : scene_files("gradients"))
        EXPECT_EQ(joined(load_scene(file).warnings), "") << file;
    const Scene scene =
        load_scene(fs::path(BURNISH_TEST_DATA) / "gradients/gradient_nearest.xml").scene;
    const std::vector<std::string> expected{
        "mat.brdf_0.base_color.data", "mat.brdf_0.roughness.data",
        "mat.brdf_0.metallic.data",   "mat.brdf_0.anisotropic.data",
        "mat.brdf_0.clearcoat.data",  "mat.brdf_0.clearcoat_gloss.data",
        "mat.brdf_0.sheen.data",      "mat.brdf_0.sheen_tint.data",
        "mat.brdf_0.spec_tint.data",  "mat.brdf_0.flatness.data"};
    EXPECT_EQ(parameter_names(scene), expected);
    for (const Parameter& parameter : scene.parameters) {
        const auto& bitmap = std::get<Bitmap>(scene[parameter.texture]);
        EXPECT_EQ(bitmap.channels, parameter.name == expected[0] ? 3 : 1);
        EXPECT_EQ(bitmap.filter, TextureFilter::kNearest);
        EXPECT_TRUE(bitmap.codes.empty());
    }
    const auto& bsdf = std::get<Principled>(scene[scene[scene.shapes.back().material].front]);
    EXPECT_TRUE(bsdf.has_clearcoat && bsdf.has_flatness && bsdf.has_sheen && bsdf.has_anisotropic);
    EXPECT_FALSE(bsdf.has_spec_trans);
}

TEST(ReferenceScenes, LanguageScene) {
    const Scene scene = load_reference("language").scene;
    ASSERT_EQ(scene.shapes.size(), 2u);
    const auto& ground = std::get<Mesh>(scene.shapes[0].geometry);
    expect_near(geometric_normal(ground, 0), {0, 1, 0}, 1e-6f);
    expect_near(geometric_normal(ground, 1), {0, 1, 0}, 1e-6f);
    expect_near(ground.positions[0], {-6, -0.9f, 6}, 1e-6f);
    EXPECT_EQ(scene[scene.shapes[0].material].id, "ground-material");
    expect_near(
        std::get<Diffuse>(scene[scene[scene.shapes[0].material].front]).reflectance.constant,
        {0.7f, 0.3f, 0.2f}, 1e-7f);
    EXPECT_EQ(scene[scene.shapes[1].material].id, "included-material");
    EXPECT_EQ(std::get<Sphere>(scene.shapes[1].geometry).center, (Vec3f{0.5f, 0, 0}));
    // <spectrum value="30"/> of an emitter is the white of equal energy.
    expect_near(std::get<PointEmitter>(scene.emitters[0]).intensity,
                Rgbf{1.204794f, 0.948291f, 0.908916f} * 30.0f, 1e-4f);
    EXPECT_EQ(scene.film.width, 96);
}

TEST(ReferenceScenes, TwosidedFacesTheCameraAndTurnsItsBack) {
    const Scene scene = load_reference("twosided_two_faces").scene;
    EXPECT_GT(geometric_normal(std::get<Mesh>(scene.shapes[0].geometry), 0).z,
              0);  // turned by 30 degrees
    EXPECT_LT(geometric_normal(std::get<Mesh>(scene.shapes[1].geometry), 0).z,
              0);  // turned by 200 degrees
    const Material& material = scene[scene.shapes[0].material];
    EXPECT_TRUE(std::holds_alternative<Diffuse>(scene[material.front]));
    EXPECT_TRUE(std::holds_alternative<Principled>(scene[material.back]));
    const Scene one_sided = load_reference("one_sided_black_back").scene;
    EXPECT_FALSE(bool(one_sided[one_sided.shapes[0].material].back));
}

TEST(ReferenceScenes, FilmCropAndFilters) {
    const Film film = load_reference("film_crop").scene.film;
    EXPECT_EQ(film.width, 64);
    EXPECT_EQ(film.crop_x, 12);
    EXPECT_EQ(film.crop_y, 20);
    EXPECT_EQ(film.crop_width, 34);
    EXPECT_EQ(film.crop_height, 28);
    EXPECT_EQ(load_reference("filter_lanczos").scene.film.filter.kind, FilterKind::kLanczos);
    EXPECT_EQ(load_reference("filter_lanczos").scene.film.filter.radius, 3.0f);
    EXPECT_EQ(load_reference("filter_tent").scene.film.filter.radius, 1.0f);
    EXPECT_EQ(load_reference("filter_box").scene.film.filter.radius, 0.5f);
    EXPECT_EQ(load_reference("filter_mitchell").scene.film.filter.kind, FilterKind::kMitchell);
    EXPECT_EQ(load_reference("filter_catmullrom").scene.film.filter.kind, FilterKind::kCatmullRom);
    EXPECT_EQ(load_reference("filter_gaussian").scene.film.filter.kind, FilterKind::kGaussian);
}

TEST(ReferenceScenes, TextureFlagsAndTransforms) {
    const Scene scene = load_reference("principled_textures").scene;
    ASSERT_EQ(scene.parameters.size(), 3u);
    EXPECT_EQ(scene.parameters[1].name, "shape_1.bsdf.brdf_0.roughness.data");
    const auto& roughness = std::get<Bitmap>(scene[scene.parameters[1].texture]);
    EXPECT_TRUE(roughness.raw);
    EXPECT_EQ(roughness.decode[128], 128 / 255.0f);
    // First the translation, then the scale.
    EXPECT_NEAR(roughness.to_uv.m[0], 1.668f, 1e-6f);
    EXPECT_NEAR(roughness.to_uv.m[2], 0.2f * 1.668f, 1e-6f);
    const auto& metallic = std::get<Bitmap>(scene[scene.parameters[2].texture]);
    EXPECT_EQ(metallic.wrap, TextureWrap::kMirror);
    EXPECT_NEAR(metallic.decode[128], srgb_to_linear(128 / 255.0f), 1e-7f);
    EXPECT_NEAR(metallic.to_uv.m[1], -0.5f, 1e-6f);
    EXPECT_NEAR(metallic.to_uv.m[3], 0.5f, 1e-6f);
}

TEST(ReferenceScenes, MeshNormalsAreComputedOrLeftOut) {
    const Scene scene = load_reference("mesh_normals").scene;
    const auto& smooth = std::get<Mesh>(scene.shapes[1].geometry);
    const auto& flat = std::get<Mesh>(scene.shapes[2].geometry);
    ASSERT_EQ(smooth.positions.size(), 625u);
    ASSERT_EQ(smooth.triangles.size(), 1152u);
    EXPECT_EQ(smooth.normals.size(), 625u);
    EXPECT_EQ(smooth.uvs.size(), 625u);
    EXPECT_TRUE(flat.normals.empty());
    for (const Vec3f& n : smooth.normals) EXPECT_NEAR(length(n), 1, 1e-5f);
    // The surface bulges: smooth normals lie near the face normals but are not them.
    EXPECT_GT(dot(smooth.normals[smooth.triangles[300].vertex[0]], geometric_normal(smooth, 300)),
              0.9f);
}

std::string tag(const char* type, const char* name, double value) {
    std::ostringstream text;
    text.precision(9);
    text << "<" << type << " name=\"" << name << "\" value=\"" << value << "\"/>";
    return text.str();
}

/// Primary rays of the table, from the camera that the scene language describes: conversions of
/// fov_axis included.
TEST(ReferenceTables, CameraRays) {
    const char* kAxes[] = {"x", "y", "diagonal", "smaller", "larger"};
    std::ifstream table(fs::path(BURNISH_TEST_DATA) / "tables/camera.csv");
    std::string line;
    std::getline(table, line);
    const TemporaryFolder folder;
    int rows = 0;
    while (std::getline(table, line)) {
        std::vector<double> v;
        std::istringstream cells(line);
        for (std::string cell; std::getline(cells, cell, ',');) v.push_back(std::stod(cell));
        ASSERT_EQ(v.size(), 21u);
        if (rows++ % 3 != 0) continue;  // three film positions share a camera: one of them
        std::ostringstream look;
        look.precision(9);
        look << "<transform name=\"to_world\"><lookat origin=\"" << v[7] << "," << v[8] << ","
             << v[9] << "\" target=\"" << v[10] << "," << v[11] << "," << v[12]
             << "\" up=\"0,1,0\"/></transform>";
        const Scene scene =
            load_text(folder,
                      "<sensor type=\"perspective\">" + tag("float", "fov", v[1]) +
                          "<string name=\"fov_axis\" value=\"" + kAxes[static_cast<int>(v[0])] +
                          "\"/>" + tag("float", "principal_point_offset_x", v[4]) +
                          tag("float", "principal_point_offset_y", v[5]) +
                          tag("float", "near_clip", v[6]) + look.str() + "<film type=\"hdrfilm\">" +
                          tag("integer", "width", v[2]) + tag("integer", "height", v[3]) +
                          "</film></sensor><emitter type=\"constant\"/>")
                .scene;
        const double t = std::tan(scene.camera.fov_x * std::numbers::pi / 360);
        const double x = v[13] + scene.camera.principal_offset_x,
                     y = v[14] + scene.camera.principal_offset_y;
        const Vec3f local{static_cast<float>((1 - 2 * x) * t),
                          static_cast<float>((1 - 2 * y) * t * v[3] / v[2]), 1};
        const Vec3f d = normalize(transform_vector(scene.camera.to_world, local));
        expect_near(
            d, {static_cast<float>(v[18]), static_cast<float>(v[19]), static_cast<float>(v[20])},
            2e-6f);
    }
    EXPECT_EQ(rows, 360);
}

TEST(PublishedScenes, LoadWithoutWarnings) {
    const char* folder = std::getenv("BURNISH_PAPER_DIR");
    if (!folder)
        GTEST_SKIP() << "BURNISH_PAPER_DIR is not set: it names the folder that holds "
                        "scenes/paper/*/scene.xml";
    const fs::path scenes = fs::path(folder) / "scenes/paper";
    const std::vector<std::pair<std::string, std::string>> expected{
        {"ashtray", "mat-ashtray.brdf_0.roughness.data"},
        {"chalice", "mat-chalice.brdf_0.roughness.data"},
        {"tire", "mat-tire.brdf_0.roughness.data"}};
    for (const auto& [name, parameter] : expected) {
        const LoadedScene loaded = load_scene(scenes / name / "scene.xml", {{}, 256, 256});
        EXPECT_EQ(joined(loaded.warnings), "") << name;
        ASSERT_FALSE(loaded.notes.empty()) << name;
        EXPECT_NE(loaded.notes[0].find("$integrator"), std::string::npos);
        EXPECT_EQ(loaded.scene.film.crop_width, 256);
        EXPECT_EQ(loaded.scene.sample_count, 512);
        const auto names = parameter_names(loaded.scene);
        EXPECT_EQ(std::count(names.begin(), names.end(), parameter), 1) << joined(names);
    }
}

}  // namespace
}  // namespace burnish
