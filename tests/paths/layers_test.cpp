// Bump maps against the reference table, on triangles with the table's tangents; the probabilities
// of the parts of blends.
#include <gtest/gtest.h>

#include <cmath>

#include "csv.h"
#include "image/files.h"
#include "paths/layers.h"
#include "random_source.h"
#include "shading/bsdf.h"
#include "worst.h"

namespace burnish::test {
namespace {

Vec3f vector_of(const CsvRow& row, const std::string& name) {
    const auto f = [&](const char* axis) { return static_cast<float>(row[name + axis]); };
    return {f("x"), f("y"), f("z")};
}

Bitmap read_heights() {
    const Image image = read_image_file(reference_folder() / "tables/texture_rgb8.png").image;
    Bitmap heights;
    heights.width = image.width, heights.height = image.height;
    heights.channels = image.channels;
    heights.values = image.values;
    return heights;
}

/// A triangle whose texture coordinates are its barycentric ones.
Scene triangle_of(const CsvRow& row, const Bitmap& heights) {
    Scene scene;
    const Vec3f normal = normalize(vector_of(row, "n_"));
    const Mesh mesh{{{0, 0, 0}, vector_of(row, "du_"), vector_of(row, "dv_")},
                    {normal, normal, normal},
                    {{0, 0}, {1, 0}, {0, 1}},
                    {{{0, 1, 2}}}};
    scene.textures = {heights};
    scene.bsdfs = {Diffuse{kWhite}};
    NormalMap map{{0}, row["flip_invalid_normals"] != 0, row["use_shadowing_function"] != 0};
    map.height_scale = static_cast<float>(row["scale"]);
    scene.materials = {{"bumpy", {0}, {}, map}};
    scene.shapes = {{"triangle", mesh, {0}, {}}};
    return scene;
}

/// What the white bsdf under the bump map reflects.
float reflected(const CsvRow& row, const Scene& scene, const Bsdf& bsdf) {
    const TriangleTable triangles = make_triangle_table(scene);
    const Vec3f wi = normalize(vector_of(row, "wi_")), wo = normalize(vector_of(row, "wo_"));
    const Hit hit{0, 0, 1, static_cast<float>(row["u"]), static_cast<float>(row["v"])};
    const Surface surface = surface_at(scene, triangles, hit, wi, -wi);
    const NormalMap& map = *scene.materials[0].normals;
    const TextureTable textures{scene.textures, {}};
    const auto [frame, old_normal] = turned_frame(map, scene, textures, hit, surface, -wi);
    return share_of_light(map, old_normal, frame.n, wo) *
           eval_bsdf(bsdf, bsdf_inputs(textures, bsdf, surface.uv), to_local(frame, wi),
                     to_local(frame, wo))
               .x;
}

/// The largest error among the rows, and how many values are not zero.
struct Agreement {
    double worst = 0;
    int lit = 0;
};

Agreement agreement(const Bsdf& bsdf, const std::string& column, float too_high = 1) {
    const Bitmap heights = read_heights();
    Agreement a;
    for (const CsvRow& row : read_csv(reference_folder() / "tables/bumpmap.csv")) {
        Scene scene = triangle_of(row, heights);
        *scene.materials[0].normals->height_scale *= too_high;
        const double expected = row[column];
        a.worst = test::worse(
            a.worst, std::abs(double{reflected(row, scene, bsdf)} - expected) / (0.01 + expected));
        a.lit += expected > 0;
    }
    return a;
}

TEST(BumpMap, AgreesWithTheTable) {
    const Agreement diffuse = agreement(Diffuse{kWhite}, "diffuse");
    EXPECT_LT(diffuse.worst, 1e-3);
    EXPECT_GT(diffuse.lit, 100);
    RoughConductor metal;
    metal.roughness = {FacetShape::kGgx, true, {{{0.5f, {}}, {0.2f, {}}}}};
    EXPECT_LT(agreement(metal, "roughconductor").worst, 1e-3);
    EXPECT_GT(agreement(metal, "roughconductor", 1.01f).worst, 2e-3);
}

/// A blend of two materials by a known weight.
Scene blend_of(float weight) {
    Scene scene;
    scene.bsdfs = {Diffuse{kWhite}};
    scene.materials = {{"blend", {0}, {}}, {"first", {0}, {}}, {"second", {0}, {}}};
    scene.materials[0].blend = MaterialBlend{{weight, {}}, {1}, {2}};
    return scene;
}

TEST(Blends, PartsOfKnownWeightsCountWhatTheyHaveToBeyondTheirRange) {
    for (const float weight : {-3.0f, -0.2f, -1e-3f, 0.0f, 0.3f, 1.0f, 1.001f, 1.4f, 5.0f}) {
        const Scene scene = blend_of(weight);
        const TextureTable textures{scene.textures, {}};
        RandomSource random{31};
        const float p = std::abs(weight) / (std::abs(weight) + std::abs(1 - weight));
        int seconds = 0;
        constexpr int kRays = 4000;
        for (int i = 0; i < kRays; ++i) {
            const LayeredPoint point{{random.next(-1, 1), random.next(-1, 1), 1}, {0, 0, -1}, {}};
            const ShownMaterial shown = shown_material(scene, textures, {0}, point);
            const bool second = shown.material == MaterialId{2};
            seconds += second;
            EXPECT_EQ(shown.share, 1);
            const bool is_within = weight >= 0 && weight <= 1;
            const float counts = second ? weight / p : (1 - weight) / (1 - p);
            EXPECT_NEAR(1 / shown.chance, counts, 1e-3f * std::abs(counts)) << weight;
            EXPECT_TRUE(is_within ? shown.chance == 1 : shown.chance < 1) << weight;
        }
        // What decides is a hash of the ray: six standard deviations.
        EXPECT_NEAR(seconds, kRays * double{p}, 6 * std::sqrt(kRays * p * (1 - p)) + 1) << weight;
    }
}

}  // namespace
}  // namespace burnish::test
