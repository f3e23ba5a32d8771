// Charts: texels that are neighbours on a surface, and every texel that a look-up can read.
#include "texture/charts.h"

#include <gtest/gtest.h>

#include <set>

#include "gradient/small_scene.h"
#include "shading/texture.h"

namespace burnish {
namespace {

/// A parallelogram in the plane z = 0 whose texture coordinates are [u0, u1] x [v0, v1].
Mesh quad(float x, float u0, float v0, float u1, float v1) {
    Mesh mesh = test::make_quad({x, 0, 0}, {1, 0, 0}, {0, 1, 0});
    mesh.uvs = {{u0, v0}, {u1, v0}, {u1, v1}, {u0, v1}};
    return mesh;
}

/// Meshes of one material whose base colour reads a bitmap of width x height texels.
Scene scene_of(const std::vector<Geometry>& shapes, int width, int height) {
    Scene scene;
    Bitmap bitmap = test::make_bitmap(1, 1, TextureFilter::kBilinear, 0, 1, 3);
    bitmap.width = width, bitmap.height = height;
    bitmap.values.assign(static_cast<std::size_t>(width * height), 0.5f);
    scene.textures = {bitmap};
    Diffuse diffuse;
    diffuse.reflectance.texture = {0};
    scene.bsdfs = {diffuse};
    scene.materials = {{"m", {0}, {}}};
    for (const Geometry& g : shapes) scene.shapes.push_back({"s", g, {0}, {}});
    return scene;
}

std::set<std::uint32_t> charts_in(const ChartMap& map, int width, int x0, int x1) {
    std::set<std::uint32_t> found;
    for (std::size_t i = 0; i < map.size(); ++i) {
        const int x = static_cast<int>(i) % width;
        if (x >= x0 && x < x1) found.insert(map[i]);
    }
    return found;
}

TEST(Charts, TellsIslandsApartAndLeavesTheirSurroundingsOut) {
    const Scene scene =
        scene_of({quad(0, 0.125f, 0, 0.375f, 1), quad(2, 0.625f, 0, 0.875f, 1)}, 32, 16);
    const ChartMap map = texture_charts(scene, {0});
    EXPECT_EQ(charts_in(map, 32, 4, 12), std::set<std::uint32_t>{1});
    EXPECT_EQ(charts_in(map, 32, 20, 28), std::set<std::uint32_t>{2});
    EXPECT_EQ(charts_in(map, 32, 13, 19), std::set<std::uint32_t>{0});
    EXPECT_EQ(charts_in(map, 32, 3, 4), std::set<std::uint32_t>{1}) << "read by look-ups within";
    EXPECT_EQ(charts_in(map, 32, 12, 13), std::set<std::uint32_t>{1});
}

TEST(Charts, AreOneAcrossAnEdgeWithEqualVerticesAndTwoAcrossOneWithOthers) {
    // The same picture: two quads side by side, in the world and in the texture.
    Mesh left = quad(0, 0, 0, 0.5f, 1), right = quad(1, 0.5f, 0, 1, 1);
    Mesh both = left;
    both.positions.insert(both.positions.end(), right.positions.begin(), right.positions.end());
    both.uvs.insert(both.uvs.end(), right.uvs.begin(), right.uvs.end());
    both.triangles.push_back({{4, 5, 6}});
    both.triangles.push_back({{4, 6, 7}});
    EXPECT_EQ(charts_in(texture_charts(scene_of({both}, 16, 8), {0}), 16, 0, 16).size(), 1u);
    for (Vec3f& p : right.positions) p.x += 5;
    EXPECT_EQ(charts_in(texture_charts(scene_of({left, right}, 16, 8), {0}), 16, 0, 16).size(), 2u);
}

/// Two quads with an edge in common, whose texture coordinates are those of two islands: a seam.
TEST(Charts, AreTwoOnBothSidesOfASeam) {
    Mesh mesh = quad(0, 0.125f, 0, 0.375f, 1);
    const Mesh right = quad(1, 0.625f, 0, 0.875f, 1);
    mesh.positions.insert(mesh.positions.end(), right.positions.begin(), right.positions.end());
    mesh.uvs.insert(mesh.uvs.end(), right.uvs.begin(), right.uvs.end());
    mesh.triangles.push_back({{4, 5, 6}});
    mesh.triangles.push_back({{4, 6, 7}});
    const ChartMap map = texture_charts(scene_of({mesh}, 32, 16), {0});
    EXPECT_EQ(charts_in(map, 32, 4, 12), std::set<std::uint32_t>{1});
    EXPECT_EQ(charts_in(map, 32, 20, 28), std::set<std::uint32_t>{2});
}

TEST(Charts, AreOneWhereTheyOverlap) {
    const Scene scene = scene_of({quad(0, 0, 0, 0.6f, 1), quad(2, 0.4f, 0, 1, 1)}, 20, 4);
    EXPECT_EQ(charts_in(texture_charts(scene, {0}), 20, 0, 20), std::set<std::uint32_t>{1});
}

TEST(Charts, AreOneForShapesWithoutTextureCoordinatesAndForManyRepetitions) {
    EXPECT_EQ(texture_charts(scene_of({Sphere{}}, 4, 4), {0}), ChartMap(16, 1));
    Mesh plain = quad(0, 0, 0, 0.1f, 0.1f);
    plain.uvs.clear();
    EXPECT_EQ(texture_charts(scene_of({plain}, 4, 4), {0}), ChartMap(16, 1));
    EXPECT_EQ(texture_charts(scene_of({quad(0, 0, 0, 1e6f, 1e6f)}, 4, 4), {0}), ChartMap(16, 1));
    EXPECT_EQ(texture_charts(scene_of({quad(0, 0, 0, NAN, 1)}, 4, 4), {0}), ChartMap(16, 1));
}

/// Thin triangles, transformed coordinates, every wrap: no look-up reads a texel of no chart.
TEST(Charts, CoverEveryTexelThatALookUpReads) {
    for (const TextureWrap wrap : {TextureWrap::kRepeat, TextureWrap::kMirror, TextureWrap::kClamp})
        for (const int size : {5, 24}) {
            test::RandomSource random{91};
            Mesh mesh;
            for (std::uint32_t i = 0; i < 60; ++i) {
                const Vec2f at{random.next(-1.0f, 2.0f), random.next(-1.0f, 2.0f)};
                const float reach = i % 2 == 0 ? 0.01f : 0.3f;
                for (std::uint32_t k = 0; k < 3; ++k) {
                    mesh.positions.push_back({random.next(0.0f, 1.0f), 0, 0});
                    mesh.uvs.push_back({at.x + random.next(-reach, reach),
                                        at.y + random.next(-reach, reach) * (i % 3 == 0 ? 0 : 1)});
                }
                mesh.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
            }
            Scene scene = scene_of({mesh}, size, size + 3);
            Bitmap& bitmap = std::get<Bitmap>(scene.textures[0]);
            bitmap.wrap = wrap;
            bitmap.to_uv = {{0.9f, 0.2f, 0.13f, -0.1f, 1.1f, 0.04f}};
            const ChartMap map = texture_charts(scene, {0});
            for (const Triangle& t : mesh.triangles)
                for (int n = 0; n < 200; ++n) {
                    float a = random.next(0.0f, 1.0f), b = random.next(0.0f, 1.0f);
                    if (a + b > 1) a = 1 - a, b = 1 - b;
                    const Vec2f uv = mesh.uvs[t.vertex[0]] * (1 - a - b) +
                                     mesh.uvs[t.vertex[1]] * a + mesh.uvs[t.vertex[2]] * b;
                    const TexelFootprint f = footprint(bitmap, uv);
                    for (int k = 0; k < f.count; ++k)
                        ASSERT_NE(map[f.texel[static_cast<std::size_t>(k)]], 0u);
                }
        }
}

}  // namespace
}  // namespace burnish
