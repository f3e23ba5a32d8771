// burnish new: the scene that it makes, meshes of three kinds of files, and what it says of bad
// ones.
#include "cli/new_scene.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <ctime>
#include <nlohmann/json.hpp>
#include <random>

#include "burnish/error.h"
#include "cli/mesh_check.h"
#include "cli/mesh_file.h"
#include "cli/program.h"
#include "error_of.h"
#include "mitsuba/load.h"
#include "mitsuba/mesh.h"

namespace burnish {
namespace {

using namespace testing;
using Document = nlohmann::json;

/// Two triangles at z = 1 with a seam between them: (0, 0, 1) to (2, 1, 1), the texture's left and
/// right half; v upwards.
constexpr const char* kObj = R"(v 0 0 1
v 2 0 1
v 2 1 1
v 0 1 1
vt 0.0 0.1
vt 0.4 0.1
vt 0.4 0.9
vt 0.6 0.1
vt 1.0 0.9
vt 0.6 0.9
f 1/1 2/2 3/3
f 1/4 3/5 4/6
)";

constexpr const char* kPlyOfCorners = R"(ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
property list uchar float texcoord
property int texnumber
end_header
0 0 1
2 0 1
2 1 1
0 1 1
3 0 1 2 6 0.0 0.1 0.4 0.1 0.4 0.9 0
3 0 2 3 6 0.6 0.1 1.0 0.9 0.6 0.9 0
)";

/// Little-endian numbers one after another, and where each part begins.
struct Data {
    std::string bytes;
    Document views = Document::array();

    template <class Number>
    int add(const std::vector<Number>& numbers) {
        while (bytes.size() % 4 != 0) bytes += '\0';
        const std::size_t begin = bytes.size(), size = numbers.size() * sizeof(Number);
        bytes.resize(begin + size);
        std::memcpy(bytes.data() + begin, numbers.data(), size);
        views.push_back({{"buffer", 0}, {"byteOffset", begin}, {"byteLength", size}});
        return static_cast<int>(views.size()) - 1;
    }
};

std::string chunk(std::uint32_t type, std::string content, char padding) {
    while (content.size() % 4 != 0) content += padding;
    const auto size = static_cast<std::uint32_t>(content.size());
    std::string head(8, '\0');
    std::memcpy(head.data(), &size, 4);
    std::memcpy(head.data() + 4, &type, 4);
    return head + content;
}

std::string glb_bytes(const Document& document, const std::string& data) {
    const std::string chunks =
        chunk(0x4E4F534A, document.dump(), ' ') + chunk(0x004E4942, data, '\0');
    const std::array<std::uint32_t, 3> head{0x46546C67, 2,
                                            static_cast<std::uint32_t>(12 + chunks.size())};
    std::string bytes(12, '\0');
    std::memcpy(bytes.data(), head.data(), 12);
    return bytes + chunks;
}

/// The same two triangles; v downwards, moved by (0, 0, 1) by its nodes, the texture coordinates
/// 16-bit integers.
struct Gltf {
    Data data;
    Document document;

    Gltf() {
        const int positions =
            data.add<float>({0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 0, 0, 2, 1, 0, 0, 1, 0});
        const auto u16 = [](double x) {
            return static_cast<std::uint16_t>(std::lround(x * 65535));
        };
        std::vector<std::uint16_t> uvs;
        for (const double x : {0.0, 0.9, 0.4, 0.9, 0.4, 0.1, 0.6, 0.9, 1.0, 0.1, 0.6, 0.1})
            uvs.push_back(u16(x));
        const int coordinates = data.add(uvs);
        const int indices = data.add<std::uint8_t>({0, 1, 2, 3, 4, 5});
        document = {
            {"asset", {{"version", "2.0"}}},
            {"scene", 0},
            {"scenes", {{{"nodes", {0}}}}},
            {"nodes",
             {{{"translation", {0, 0, 3}}, {"children", {1}}},
              {{"mesh", 0}, {"translation", {0, 0, -2}}}}},
            {"meshes",
             {{{"primitives",
                {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}, {"indices", 2}}}}}}},
            {"accessors",
             {{{"bufferView", positions}, {"componentType", 5126}, {"count", 6}, {"type", "VEC3"}},
              {{"bufferView", coordinates},
               {"componentType", 5123},
               {"normalized", true},
               {"count", 6},
               {"type", "VEC2"}},
              {{"bufferView", indices},
               {"componentType", 5121},
               {"count", 6},
               {"type", "SCALAR"}}}},
            {"bufferViews", data.views},
            {"buffers", {{{"byteLength", data.bytes.size()}}}}};
    }
    std::string bytes() const { return glb_bytes(document, data.bytes); }
};

/// Its material, whose first texture is read with this of glTF's textureInfo.
void add_material(const Document& texture, Document& document) {
    document["materials"] = {
        {{"normalTexture", texture}, {"emissiveTexture", {{"index", 0}, {"texCoord", 7}}}}};
    document["meshes"][0]["primitives"][0]["material"] = 0;
}

Document with_transform(const Document& transform) {
    return {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}};
}

/// Its texture coordinates in 12 bits of 16, as gltfpack packs them, turned by a quarter or not.
Gltf packed(const Document& transform, bool is_normalized, bool is_turned) {
    Gltf gltf;
    std::array<std::uint16_t, 12> codes{};
    char* begin = gltf.data.bytes.data() + gltf.data.views[1]["byteOffset"].get<std::size_t>();
    std::memcpy(codes.data(), begin, sizeof codes);
    for (std::uint16_t& c : codes) c = static_cast<std::uint16_t>(std::lround(c * 4095 / 65535.0));
    if (is_turned)
        for (std::size_t i = 0; i < codes.size(); i += 2) {
            std::swap(codes[i], codes[i + 1]);
            codes[i] = static_cast<std::uint16_t>(4095 - codes[i]);
        }
    std::memcpy(begin, codes.data(), sizeof codes);
    gltf.document["accessors"][1]["normalized"] = is_normalized;
    add_material(with_transform(transform), gltf.document);
    return gltf;
}

struct NewSceneTest : Program {
    fs::path obj = folder / "model.obj", ply = folder / "model.ply", glb = folder / "model.glb";

    NewSceneTest() {
        write_text(obj, kObj);
        write_text(ply, kPlyOfCorners);
        write_text(glb, Gltf().bytes());
    }
    std::string complaint(const fs::path& file) const {
        return test::error_of([&] { read_mesh(file); });
    }
    std::string complaint(const Document& document,
                          const std::string& data = Gltf().data.bytes) const {
        write_text(glb, glb_bytes(document, data));
        return complaint(glb);
    }
};

/// Position and texture coordinate of each corner of each triangle.
std::vector<std::array<float, 5>> corners(const Mesh& mesh) {
    std::vector<std::array<float, 5>> all;
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t.vertex)
            all.push_back({mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z,
                           mesh.uvs[v].x, mesh.uvs[v].y});
    return all;
}

TEST_F(NewSceneTest, ReadsTheSameMeshFromEveryKindOfFile) {
    const auto expected = corners(read_mesh(obj).mesh);
    ASSERT_EQ(expected.size(), 6u);
    EXPECT_EQ(expected[1], (std::array<float, 5>{2, 0, 1, 0.4f, 0.9f}));
    for (const fs::path& file : {ply, glb}) {
        const auto found = corners(read_mesh(file).mesh);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t i = 0; i < found.size(); ++i)
            for (std::size_t k = 0; k < 5; ++k)
                EXPECT_NEAR(found[i][k], expected[i][k], 1e-5) << file << i;
    }
}

TEST_F(NewSceneTest, ReadsTextureCoordinatesOfIntegersWithTheTransformOfTheTexture) {
    const auto expected = corners(read_mesh(obj).mesh);
    const double of_normalized = 65535.0 / 4095, of_codes = 1 / 4095.0;
    const Gltf files[] = {
        packed({{"scale", {of_normalized, of_normalized}}}, true, false),
        packed({{"scale", {of_codes, of_codes}}, {"offset", {0, 0}}}, false, false),
        packed({{"scale", {of_codes, of_codes}}, {"rotation", 1.57079632679}, {"offset", {0, 1}}},
               false, true)};
    for (const Gltf& file : files) {
        write_text(glb, file.bytes());
        const FoundMesh read = read_mesh(glb);
        EXPECT_TRUE(read.notes.empty());
        const auto found = corners(read.mesh);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t i = 0; i < found.size(); ++i)
            for (std::size_t k = 0; k < 5; ++k)
                EXPECT_NEAR(found[i][k], expected[i][k], 2e-4) << file.document["materials"] << i;
    }
}

TEST_F(NewSceneTest, TurnsTextureCoordinatesAsASceneDoesThatReadsTheSameObj) {
    write_text(folder / "scene.xml", R"(<scene version="3.0.0"><shape type="obj">
        <string name="filename" value="model.obj"/></shape></scene>)");
    const LoadedScene loaded = load_scene(folder / "scene.xml");
    EXPECT_EQ(corners(*mesh_of(loaded.scene.shapes.front().geometry)),
              corners(read_mesh(obj).mesh));
}

/// As rounding to few digits leaves it.
TEST_F(NewSceneTest, AQuaternionOfAlmostLength1IsARotation) {
    Document document = Gltf().document;
    const auto positions = [&](const Document& rotation) {
        document["nodes"][1]["rotation"] = rotation;
        write_text(glb, glb_bytes(document, Gltf().data.bytes));
        return read_mesh(glb).mesh.positions;
    };
    const auto exact = positions({0, 0, 0.6, 0.8}), found = positions({0, 0, 0.6005, 0.8005});
    ASSERT_EQ(found.size(), exact.size());
    for (std::size_t i = 0; i < exact.size(); ++i)
        EXPECT_NEAR(length(found[i]), length(exact[i]), 1e-5) << i;
}

TEST_F(NewSceneTest, ReadsStripsFansAndMirroredNodes) {
    Data data;
    data.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
    Document document = Gltf().document;
    document["meshes"][0]["primitives"][0] = {{"attributes", {{"POSITION", 0}}}, {"mode", 5}};
    document["nodes"][1] = {{"mesh", 0}, {"scale", {-1, 1, 1}}};
    document["accessors"] = {
        {{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}}};
    document["bufferViews"] = data.views;
    for (const int mode : {5, 6}) {
        document["meshes"][0]["primitives"][0]["mode"] = mode;
        write_text(glb, glb_bytes(document, data.bytes));
        const FoundMesh file = read_mesh(glb);
        EXPECT_TRUE(file.mesh.uvs.empty());
        ASSERT_EQ(file.mesh.triangles.size(), 2u);
        // Both triangles of the strip look to +z, and keep to it under the mirror.
        const Triangle& t = file.mesh.triangles[mode == 5 ? 1 : 0];
        const auto p = [&](std::size_t i) { return file.mesh.positions[t.vertex[i]]; };
        EXPECT_GT(cross(p(1) - p(0), p(2) - p(0)).z, 0) << mode;
        EXPECT_EQ(p(0).x, mode == 5 ? 0.0f : 0.0f);
    }
}

/// A cube around the origin whose faces share their vertices; u and v are x and y.
Gltf cube_without_normals() {
    Gltf cube;
    cube.data = {};
    std::vector<float> positions, uvs;
    for (int v = 0; v < 8; ++v) {
        for (int k = 0; k < 3; ++k) positions.push_back(v & (1 << k) ? 1.0f : -1.0f);
        uvs.insert(uvs.end(), positions.end() - 3, positions.end() - 1);
    }
    cube.data.add(positions), cube.data.add(uvs);
    cube.data.add<std::uint8_t>({0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                 2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6});
    Document& document = cube.document;
    document["nodes"] = {{{"mesh", 0}}};
    document["bufferViews"] = cube.data.views;
    document["buffers"][0]["byteLength"] = cube.data.bytes.size();
    document["accessors"][0]["count"] = 8;
    document["accessors"][1] = {
        {"bufferView", 1}, {"componentType", 5126}, {"count", 8}, {"type", "VEC2"}};
    document["accessors"][2]["count"] = 36;
    return cube;
}

TEST_F(NewSceneTest, APrimitiveOfAGlbWithoutNormalsHasFlatFaces) {
    Gltf gltf = cube_without_normals();
    for (const float mirror : {1.0f, -1.0f}) {
        gltf.document["nodes"][0]["scale"] = {mirror, 1, 1};
        write_text(glb, gltf.bytes());
        const Mesh mesh = read_mesh(glb).mesh;
        ASSERT_EQ(mesh.positions.size(), 36u);
        ASSERT_EQ(mesh.normals.size(), 36u);
        ASSERT_EQ(mesh.triangles.size(), 12u);
        for (const Triangle& t : mesh.triangles) {
            const auto p = [&](std::size_t i) { return mesh.positions[t.vertex[i]]; };
            const Vec3f normal = normalize(cross(p(1) - p(0), p(2) - p(0)));
            EXPECT_GT(dot(normal, p(0)), 0);
            for (const std::uint32_t v : t.vertex) {
                EXPECT_EQ(length(mesh.normals[v] - normal), 0) << mirror;
                EXPECT_EQ(mesh.uvs[v].x, mirror * mesh.positions[v].x);
                EXPECT_EQ(mesh.uvs[v].y, mesh.positions[v].y);
            }
        }
    }
}

/// Three numbers for each of its six vertices.
void add_normals(const std::vector<float>& normals, Gltf& gltf) {
    const int view = gltf.data.add(normals);
    Document& document = gltf.document;
    document["bufferViews"] = gltf.data.views;
    document["buffers"][0]["byteLength"] = gltf.data.bytes.size();
    document["accessors"].push_back(
        {{"bufferView", view}, {"componentType", 5126}, {"count", 6}, {"type", "VEC3"}});
    document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 3;
}

TEST_F(NewSceneTest, APrimitiveOfAGlbKeepsItsNormalsBesideOneWithoutThem) {
    Gltf gltf;
    Document& primitives = gltf.document["meshes"][0]["primitives"];
    const Document without = primitives[0];
    add_normals({0.6f, 0, 0.8f, 0, 0, 1, 0, 0.28f, 0.96f, 0.6f, 0, 0.8f, 0, 0.28f, 0.96f, 0, 1, 0},
                gltf);
    write_text(glb, gltf.bytes());
    const std::vector<Vec3f> expected = read_mesh(glb).mesh.normals;
    ASSERT_EQ(expected.size(), 6u);
    EXPECT_NEAR(expected[2].y, 0.28, 1e-6);
    primitives.push_back(without);
    write_text(glb, gltf.bytes());
    const std::vector<Vec3f> found = read_mesh(glb).mesh.normals;
    ASSERT_EQ(found.size(), 12u);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(length(found[i] - expected[i]), 0) << i;
    for (std::size_t i = 6; i < 12; ++i) EXPECT_EQ(length(found[i] - Vec3f{0, 0, 1}), 0) << i;
}

/// A cylinder of four faces about the y axis, without ends and normals: each face is a chart, in
/// PLY the texture coordinates of the corners of a face or vertices of its own.
struct CylinderFiles {
    std::string obj, ply_of_corners, ply_of_vertices;

    CylinderFiles() {
        constexpr const char* kPositions[] = {"1 0 0",  "1 1 0",  "0 0 -1", "0 1 -1",
                                              "-1 0 0", "-1 1 0", "0 0 1",  "0 1 1"};
        std::string corner_faces, vertices, vertex_faces;
        for (const char* p : kPositions) obj += fmt::format("v {}\n", p);
        for (const char* p : kPositions) ply_of_corners += fmt::format("{}\n", p);
        for (int face = 0; face < 4; ++face) {
            const int corners[] = {2 * face, 2 * face + 2, 2 * face + 3, 2 * face + 1};
            const double left = 0.25 * face, right = left + 0.2;
            const std::string uvs[] = {fmt::format("{} 0", left), fmt::format("{} 0", right),
                                       fmt::format("{} 1", right), fmt::format("{} 1", left)};
            std::string obj_face = "f", list;
            for (int i = 0; i < 4; ++i) {
                const int p = corners[i] % 8;
                obj += fmt::format("vt {}\n", uvs[i]);
                obj_face += fmt::format(" {}/{}", p + 1, 4 * face + i + 1);
                list += fmt::format(" {}", p);
                vertices += fmt::format("{} {}\n", kPositions[p], uvs[i]);
            }
            obj += obj_face + "\n";
            corner_faces += fmt::format("4{} 8 {}\n", list, fmt::join(uvs, " "));
            vertex_faces +=
                fmt::format("4 {} {} {} {}\n", 4 * face, 4 * face + 1, 4 * face + 2, 4 * face + 3);
        }
        const auto header = [](int count, const char* of_vertices, const char* of_faces) {
            return fmt::format(
                "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
                "property float z\n{}element face 4\nproperty list uchar int vertex_indices\n"
                "{}end_header\n",
                count, of_vertices, of_faces);
        };
        ply_of_corners =
            header(8, "", "property list uchar float texcoord\n") + ply_of_corners + corner_faces;
        ply_of_vertices =
            header(16, "property float u\nproperty float v\n", "") + vertices + vertex_faces;
    }
};

TEST_F(NewSceneTest, SmoothNormalsGoAcrossSeamsOfTheTexture) {
    const CylinderFiles cylinder;
    write_text(obj, cylinder.obj);
    const fs::path of_vertices = folder / "of_vertices.ply";
    write_text(ply, cylinder.ply_of_corners);
    write_text(of_vertices, cylinder.ply_of_vertices);
    for (const fs::path& file : {obj, ply, of_vertices}) {
        const Mesh mesh = read_mesh(file).mesh;
        ASSERT_EQ(mesh.positions.size(), 16u) << file;
        for (std::size_t v = 0; v < 16; ++v) {
            const Vec3f p = mesh.positions[v];
            // A face has a triangle more at two of its corners.
            EXPECT_GT(dot(mesh.normals[v], Vec3f{p.x, 0, p.z}), 0.9f) << file << v;
            for (std::size_t other = 0; other < v; ++other)
                if (mesh.positions[other] == p) {
                    EXPECT_EQ(mesh.normals[other], mesh.normals[v]) << file << v;
                }
        }
    }
}

TEST_F(NewSceneTest, SmoothNormalsKeepToTheirSideOfASheet) {
    write_text(obj,
               "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 0.4 0\nvt 0 0.4\nvt 0.5 0.5\nvt 1 0.5\n"
               "vt 0.5 1\nf 1/1 2/2 3/3\nf 1/4 3/6 2/5\n");
    const Mesh mesh = read_mesh(obj).mesh;
    ASSERT_EQ(mesh.normals.size(), 6u);
    for (std::size_t v = 0; v < 6; ++v)
        EXPECT_EQ(mesh.normals[v], (Vec3f{0, 0, v < 3 ? 1.0f : -1.0f})) << v;
}

TEST_F(NewSceneTest, NormalsOf000AreThoseOfTheFacesAroundAndAreCounted) {
    const std::vector<std::string> counted{
        "1 vertex has the normal 0 0 0: computed from the faces around"};
    const auto expect = [&](const fs::path& file) {
        const FoundMesh read = read_mesh(file);
        EXPECT_EQ(read.notes, counted) << file;
        for (const Vec3f& n : read.mesh.normals)
            EXPECT_EQ(length(n - Vec3f{0, 0, 1}), 0) << file << n.x;
    };
    write_text(obj,
               "v 0 0 0\nv 2 0 0\nv 2 1 0\nvt 0 0\nvn 0 0 1\nvn 0 0 0\n"
               "f 1/1/1 2/1/2 3/1/1\n");
    expect(obj);
    Gltf gltf;
    add_normals({0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, gltf);
    for (const float mirror : {1.0f, -1.0f}) {
        gltf.document["nodes"][1]["scale"] = {mirror, 1, 1};
        write_text(glb, gltf.bytes());
        expect(glb);
    }
}

TEST_F(NewSceneTest, FacesOfAGlbWithoutAreaHaveNoNormalsToCount) {
    Gltf gltf;
    char* begin = gltf.data.bytes.data();
    std::memcpy(begin + 12, begin, 12);  // of the first triangle two corners are one
    write_text(glb, gltf.bytes());
    const FoundMesh read = read_mesh(glb);
    EXPECT_EQ(read.notes, std::vector<std::string>{});
    for (const Vec3f& n : read.mesh.normals) EXPECT_NEAR(length(n), 1, 1e-6);
}

/// `text` with another part in the place of one that it has.
std::string with(std::string text, const std::string& part, const std::string& other) {
    return text.replace(text.find(part), part.size(), other);
}

TEST_F(NewSceneTest, SaysWhatOfAFileIsNotRead) {
    const auto notes = [](const fs::path& file) {
        std::string all;
        for (const std::string& note : read_mesh(file).notes) all += note + "\n";
        return all;
    };
    for (const fs::path& file : {obj, ply, glb}) EXPECT_EQ(notes(file), "") << file;

    const std::string materials = "its 2 materials become one, which shares one set of textures\n";
    const std::string red = with(kObj, "f 1/1", "usemtl red one\nf 1/1");
    write_text(obj, with(red, "f 1/4", "usemtl red two # 2\nf 1/4"));
    EXPECT_EQ(notes(obj), materials);
    write_text(obj, with(red, "f 1/4", "usemtl red one # again\nf 1/4"));
    EXPECT_EQ(notes(obj), "");
    write_text(ply, with(kPlyOfCorners, "0.6 0.9 0\n", "0.6 0.9 1\n"));
    EXPECT_EQ(notes(ply), materials);

    Document document = Gltf().document;
    document["nodes"][1]["skin"] = 0;
    document["nodes"][1]["extensions"]["EXT_mesh_gpu_instancing"] = Document::object();
    document["meshes"][0]["primitives"][0]["targets"] = Document::array();
    write_text(glb, glb_bytes(document, Gltf().data.bytes));
    const std::string found = notes(glb);
    for (const char* what : {"skins are", "morph targets are", "EXT_mesh_gpu_instancing is"})
        EXPECT_TRUE(contains(found, what + std::string(" not read: a mesh "))) << found;
}

TEST_F(NewSceneTest, SaysWhereTexturesAreReadElsewhereThanTheirCoordinates) {
    const auto notes = [&](Gltf gltf, const Document& texture) {
        write_text(glb, gltf.bytes());
        const auto without_material = corners(read_mesh(glb).mesh);
        add_material(texture, gltf.document);
        write_text(glb, gltf.bytes());
        const FoundMesh read = read_mesh(glb);
        EXPECT_EQ(corners(read.mesh), without_material);
        return read.notes;
    };
    using Notes = std::vector<std::string>;
    const Gltf floats = cube_without_normals(), integers;
    const Document twice = {{"scale", {2, 2}}};
    Document other = with_transform(twice);
    other["extensions"]["KHR_texture_transform"]["texCoord"] = 3;
    EXPECT_EQ(notes(floats, {{"index", 0}}), Notes{});
    EXPECT_EQ(notes(floats, with_transform({{"scale", {1, 1}}})), Notes{});
    EXPECT_EQ(notes(floats, with_transform(twice)),
              Notes{"KHR_texture_transform is not read: TEXCOORD_0 counts as it is"});
    EXPECT_EQ(notes(integers, {{"index", 0}, {"texCoord", 1}}),
              Notes{"TEXCOORD_1 is not read, at which a material has its textures: TEXCOORD_0 "
                    "counts"});
    EXPECT_EQ(notes(integers, other),
              Notes{"TEXCOORD_3 is not read, at which a material has its textures: TEXCOORD_0 "
                    "counts"});
}

/// A square, and one with a notch.
TEST_F(NewSceneTest, SaysHowManyFacesAreNotConvex) {
    write_text(obj,
               "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 1.5 1 0\nf 1 2 3 4\nf 1 2 3 4 5\nf 4 5 1\n");
    write_text(ply,
               "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
               "property float z\nelement face 3\nproperty list uchar int vertex_indices\n"
               "end_header\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n1.5 1 0\n4 0 1 2 3\n5 0 1 2 3 4\n"
               "3 3 4 0\n");
    for (const fs::path& file : {obj, ply}) {
        const std::vector<std::string> notes = read_mesh(file).notes;
        ASSERT_EQ(notes.size(), 1u) << file;
        EXPECT_TRUE(
            contains(notes[0], "1 of the faces with more than three corners are not convex"))
            << notes[0];
    }
}

TEST_F(NewSceneTest, SaysHowManyCornersLackWhatOthersHave) {
    write_text(obj,
               "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n"
               "f 1/1/1 2/2/1 3/3/1\nf 1/1 3 4\n");
    EXPECT_EQ(read_mesh(obj).notes,
              (std::vector<std::string>{
                  "2 corners of the faces lack the texture coordinates that others have: read as "
                  "0 0",
                  "3 corners of the faces lack the normals that others have: computed from the "
                  "faces around them"}));
}

TEST_F(NewSceneTest, MakesASceneThatRendersAndNamesItsTextures) {
    write_image(folder / "sky.exr", make_image(8, 4, 3, 2.0f));
    const Outcome made =
        run("new --mesh model.glb --environment sky.exr -o scene/ --texture-size 32");
    ASSERT_EQ(made.code, 0) << made.err;
    fs::copy(obj, folder / "sky.obj");
    EXPECT_EQ(run("new --mesh sky.obj -o named").code, 0) << "the sky has that name";
    EXPECT_TRUE(contains(made.err, "2 triangles in 2 charts, 33 % of the texture is used"))
        << made.err;
    EXPECT_FALSE(contains(made.err, "warning")) << made.err;
    EXPECT_FALSE(fs::exists(folder / "scene/.burnish-unfinished"));
    const LoadedScene loaded = load_scene(folder / "scene/scene.xml");
    ASSERT_EQ(loaded.scene.parameters.size(), 2u);
    EXPECT_EQ(loaded.scene.parameters[0].name, "mat-model.brdf_0.base_color.data");
    EXPECT_EQ(loaded.scene.parameters[1].name, "mat-model.brdf_0.roughness.data");
    for (const Parameter& p : loaded.scene.parameters) {
        const auto& bitmap = std::get<Bitmap>(loaded.scene[p.texture]);
        EXPECT_EQ(bitmap.width, 32);
        for (const float v : bitmap.values) EXPECT_EQ(v, 0.5f);
    }
    const Outcome shown = run("render scene/scene.xml -D resx=24 -D resy=24 -o look.exr");
    ASSERT_EQ(shown.code, 0) << shown.err;
    const Image image = read_image(folder / "look.exr");
    // The middle shows the mesh, a dielectric under a sky of 2; a corner the sky.
    EXPECT_GT(image.at(12, 12, 0), 0.5f);
    EXPECT_LT(image.at(12, 12, 0), 1.9f);
    EXPECT_NEAR(image.at(0, 0, 0), 2.0f, 0.02f);
}

/// kObj, whose faces look to the other side.
std::string turned_obj() {
    return with(with(kObj, "f 1/1 2/2 3/3", "f 3/3 2/2 1/1"), "f 1/4 3/5 4/6", "f 4/6 3/5 1/4");
}

TEST_F(NewSceneTest, AnOpenMeshIsLitOnBothSides) {
    write_text(folder / "back.obj", turned_obj());
    std::vector<double> shown;
    for (const std::string name : {"model", "back"}) {
        const Outcome made = run("new --mesh " + name + ".obj -o " + name);
        ASSERT_EQ(made.code, 0) << made.err;
        EXPECT_TRUE(contains(made.err, "--parameter mat-" + name + ".base_color")) << made.err;
        ASSERT_EQ(
            run("render " + name + "/scene.xml -D resx=8 -D resy=8 --spp 256 -o look.exr").code, 0);
        const Image image = read_image(folder / "look.exr");
        shown.push_back(0.25 * (double{image.at(3, 3, 0)} + double{image.at(4, 3, 0)} +
                                double{image.at(3, 4, 0)} + double{image.at(4, 4, 0)}));
    }
    EXPECT_GT(shown[0], 0.3);
    EXPECT_NEAR(shown[1], shown[0], 0.06);
}

TEST_F(NewSceneTest, AClosedMeshHasOneSideUnlessItsMaterialHasTwo) {
    Gltf cube = cube_without_normals();
    cube.document["materials"] = {{{"doubleSided", true}}};
    Document& primitive = cube.document["meshes"][0]["primitives"][0];
    for (const bool both : {false, true}) {
        if (both) primitive["material"] = 0;
        write_text(glb, cube.bytes());
        const std::string out = both ? "two" : "one";
        ASSERT_EQ(run("new --mesh model.glb -o " + out).code, 0);
        const std::string scene = read_text(folder / out / "scene.xml");
        EXPECT_EQ(contains(scene, "twosided"), both);
        const LoadedScene loaded = load_scene(folder / out / "scene.xml");
        EXPECT_EQ(loaded.scene.parameters[0].name,
                  both ? "mat-model.brdf_0.base_color.data" : "mat-model.base_color.data");
    }
}

/// The mesh of kObj, so many times as large.
std::string obj_of_size(double s) {
    const std::string text = kObj;
    return fmt::format("v 0 0 {0}\nv {1} 0 {0}\nv {1} {0} {0}\nv 0 {0} {0}\n", s, 2 * s) +
           text.substr(text.find("vt"));
}

TEST_F(NewSceneTest, APictureDoesNotDependOnTheUnitsOfTheMesh) {
    std::vector<Image> images;
    for (const double size : {1.0, 5000.0, 0.002}) {
        write_text(folder / "unit.obj", obj_of_size(size));
        const std::string out = fmt::format("units{}", size);
        ASSERT_EQ(run("new --mesh unit.obj -o " + out).code, 0);
        ASSERT_EQ(
            run("render " + out + "/scene.xml -D resx=16 -D resy=16 --spp 16 -o look.exr").code, 0);
        images.push_back(read_image(folder / "look.exr"));
        const bool has_planes = contains(read_text(folder / out / "scene.xml"), "_clip");
        EXPECT_EQ(has_planes, size != 1) << size;
    }
    for (std::size_t i = 1; i < images.size(); ++i) {
        double difference = 0;
        for (std::size_t k = 0; k < images[0].values.size(); ++k)
            difference += std::abs(double{images[i].values[k]} - double{images[0].values[k]});
        EXPECT_LT(difference / static_cast<double>(images[0].values.size()), 0.002) << i;
    }
}

TEST_F(NewSceneTest, ItsClippingPlanesSuitAllPictures) {
    const auto planes = [&](double size, const char* frames) {
        write_text(folder / "unit.obj", obj_of_size(size));
        write_text(
            folder / "transforms.json",
            fmt::format(R"({{"w": 60, "h": 30, "fl_x": 60, "fl_y": 60, "frames": [{}]}})", frames));
        fs::remove_all(folder / "views");
        EXPECT_EQ(run("new --mesh unit.obj --views transforms.json -o views").code, 0);
        const PerspectiveCamera camera = load_scene(folder / "views/scene.xml").scene.camera;
        return std::pair(camera.near_clip, camera.far_clip);
    };
    const auto at = [](double z) {
        return fmt::format(R"({{"file_path": "{0}.png", "transform_matrix":
            [[1,0,0,0], [0,1,0,0], [0,0,1,{0}], [0,0,0,1]]}})",
                           z);
    };
    EXPECT_EQ(planes(1, at(5).c_str()), std::pair(0.01f, 10000.0f));
    const auto [near, far] = planes(0.002, (at(5) + "," + at(0.012)).c_str());
    EXPECT_LT(near, 0.001f);
    EXPECT_EQ(far, 10000);
    EXPECT_GT(planes(5000, (at(9000) + "," + at(40000)).c_str()).second, 40000);
}

TEST_F(NewSceneTest, TheSkyTurnsAboutTheAxisThatPointsUp) {
    write_image(folder / "sky.exr", make_image(8, 4, 3, 1.0f));
    for (const std::string up : {"y", "z"}) {
        const Outcome made =
            run("new --mesh model.obj --environment sky.exr --up " + up + " -o " + up);
        ASSERT_EQ(made.code, 0) << made.err;
        const auto turned = [&](const char* degrees) {
            const Scene scene =
                load_scene(folder / up / "scene.xml", {.definitions = {{"sky_turn", degrees}}})
                    .scene;
            return std::get<EnvironmentEmitter>(scene.emitters.front()).to_world;
        };
        const Vec3f before = transform_vector(turned("0"), Vec3f{1, 0.5f, 0});
        const Vec3f after = transform_vector(turned("90"), Vec3f{1, 0.5f, 0});
        const Vec3f axis = up == "y" ? Vec3f{0, 1, 0} : Vec3f{0, 0, 1};
        EXPECT_NEAR(dot(before, axis), 0.5, 1e-6) << up;
        EXPECT_NEAR(dot(after, axis), 0.5, 1e-6) << up;
        EXPECT_NEAR(dot(before, after), 0.25, 1e-6) << up;
    }
}

TEST_F(NewSceneTest, TheCameraSeesAllOfTheMeshWhicheverAxisPointsUp) {
    for (const std::string up : {"y", "z"}) {
        const Outcome made = run("new --mesh model.obj --up " + up + " -o " + up);
        ASSERT_EQ(made.code, 0) << made.err;
        EXPECT_TRUE(contains(made.err, "no --environment")) << made.err;
        const Scene scene = load_scene(folder / up / "scene.xml").scene;
        const Transform to_camera = inverse(scene.camera.to_world);
        for (const Vec3f& p : mesh_of(scene.shapes.front().geometry)->positions) {
            const Vec3f q = transform_point(to_camera, p);
            EXPECT_GT(q.z, 0);
            const double reach =
                std::tan(0.5 * scene.camera.fov_x * 3.14159265 / 180) * double{q.z};
            EXPECT_LT(std::abs(q.x), reach);
            EXPECT_LT(std::abs(q.y), reach);
        }
    }
}

TEST_F(NewSceneTest, TheCameraLooksAtAMeshFarFromTheOrigin) {
    const std::string text = kObj;
    write_text(folder / "far.obj",
               "v 500000 4649776 1\nv 500008 4649776 1\nv 500008 4649780 1\n"
               "v 500000 4649780 1\n" +
                   text.substr(text.find("vt")));
    const Outcome made = run("new --mesh far.obj -o far");
    ASSERT_EQ(made.code, 0) << made.err;
    EXPECT_TRUE(contains(made.err, "times its own size from the origin")) << made.err;
    const Transform to_world = load_scene(folder / "far/scene.xml").scene.camera.to_world;
    // How far the ray through the middle of the picture passes the middle of the mesh.
    const Vec3<double> origin{to_world(0, 3), to_world(1, 3), to_world(2, 3)},
        axis{to_world(0, 2), to_world(1, 2), to_world(2, 2)};
    const Vec3<double> to_middle = Vec3<double>{500004, 4649778, 1} - origin;
    EXPECT_LT(length(cross(axis, to_middle)), 0.1);
    EXPECT_GT(dot(axis, to_middle), 0);
}

/// A camera of OpenGL's axes that looks along -z, at (1, 0.5, z); its principal point is aside.
std::string transforms_at(double z) {
    return fmt::format(
        R"({{"w": 60, "h": 30, "fl_x": 60, "fl_y": 60, "cx": 40, "cy": 10,
        "frames": [{{"file_path": "a.png",
        "transform_matrix": [[1,0,0,1], [0,1,0,0.5], [0,0,1,{}], [0,0,0,1]]}}]}})",
        z);
}

TEST_F(NewSceneTest, TakesTheCameraOfTheFirstPicture) {
    write_text(folder / "transforms.json", transforms_at(5));
    const Outcome made = run("new --mesh model.obj --views transforms.json -o scene");
    ASSERT_EQ(made.code, 0) << made.err;
    EXPECT_FALSE(contains(made.err, "warning")) << made.err;
    EXPECT_TRUE(contains(made.err, "optimize scene/scene.xml --views transforms.json")) << made.err;
    const Scene scene = load_scene(folder / "scene/scene.xml").scene;
    EXPECT_EQ(scene.film.width, 60);
    EXPECT_EQ(scene.film.height, 30);
    EXPECT_NEAR(scene.camera.fov_x, 2 * std::atan(0.5) * 180 / 3.14159265358979, 1e-6);
    EXPECT_NEAR(scene.camera.principal_offset_x, 0.5 - 40 / 60.0, 1e-6);
    EXPECT_NEAR(scene.camera.principal_offset_y, 0.5 - 10 / 30.0, 1e-6);
    const Transform to_camera = inverse(scene.camera.to_world);
    // The mesh's corner (2, 1, 1): to the right of the middle (x points left), above it, 4 before.
    const Vec3f p = transform_point(to_camera, Vec3f{2, 1, 1});
    EXPECT_NEAR(p.x, -1, 1e-6);
    EXPECT_NEAR(p.y, 0.5, 1e-6);
    EXPECT_NEAR(p.z, 4, 1e-6);

    write_text(folder / "transforms.json", transforms_at(-5));
    const Outcome away = run("new --mesh model.obj --views transforms.json -o other");
    EXPECT_EQ(away.code, 0) << away.err;
    EXPECT_TRUE(contains(away.err, "lies in 0 of 1 pictures")) << away.err;
}

/// Through a pinhole it would lie aside of each, or behind the camera.
TEST_F(NewSceneTest, RefusesACameraThatASceneCannotHave) {
    const std::string views = transforms_at(5);
    const std::pair<std::string, std::string> cases[] = {
        {with(views, "[1,0,0,1]", "[1,0,0,1e13]"), "the camera is further than 1e12 from"},
        {with(views, "\"cx\": 40", "\"cx\": 1e6"),
         "the principal point is at (1e+06, 10) pixels, expected it within 1000 widths"},
        {with(with(views, "\"w\": 60", "\"w\": 30000"), "\"h\": 30", "\"h\": 30000"),
         "the camera has 30000 x 30000 pixels: expected at most 134217728 in all"}};
    for (const auto& [text, complaint] : cases) {
        write_text(folder / "transforms.json", text);
        const Outcome made = run("new --mesh model.obj --views transforms.json -o scene");
        EXPECT_EQ(made.code, 65) << made.err;
        EXPECT_TRUE(made.err.starts_with("burnish: transforms.json: frames[0]: " + complaint))
            << made.err;
        EXPECT_FALSE(fs::exists(folder / "scene"));
    }
}

TEST_F(NewSceneTest, ErrorsNameTheSceneThatWouldBe) {
    const Outcome made = shell("ulimit -f 8; '" BURNISH_BINARY "' new --mesh model.obj -o scene/");
    EXPECT_EQ(made.code, 73) << made.err;
    EXPECT_TRUE(made.err.starts_with("burnish: scene/textures/model_base_color.exr: ")) << made.err;
    EXPECT_FALSE(contains(made.err, "unfinished")) << made.err;
}

TEST_F(NewSceneTest, NotesWhatOfTheSkyIsNotRead) {
    write_image(folder / "sky.exr", make_image(8, 4, 3, -1.0f));
    const Outcome made = run("new --mesh model.obj --environment sky.exr -o scene/");
    ASSERT_EQ(made.code, 0) << made.err;
    EXPECT_TRUE(contains(made.err, "note: scene/scene.xml:")) << made.err;
    EXPECT_TRUE(contains(made.err, "texels of negative luminance: read as black")) << made.err;
    EXPECT_FALSE(contains(made.err, "unfinished")) << made.err;
}

TEST_F(NewSceneTest, ALensMayShowTheMeshWhereAPinholeWouldNot) {
    struct Case {
        const char* lens;
        double x, z;     // of the camera, which looks along -z; the mesh's middle: (1, 0.5, 1)
        bool is_inside;  // of the picture
    };
    const Case cases[] = {
        {R"("camera_model": "OPENCV_FISHEYE", "fl_x": 18, "fl_y": 18)", -9, 2, true},
        {R"("camera_model": "OPENCV_FISHEYE", "fl_x": 18, "fl_y": 18)", -9, 0.5, true},
        {R"("camera_model": "OPENCV_FISHEYE", "fl_x": 18, "fl_y": 18)", -9, -4, false},
        {R"("camera_model": "OPENCV", "k1": -0.1, "fl_x": 28, "fl_y": 28)", -5, 6, true},
        {R"("camera_model": "OPENCV", "k1": -0.1, "fl_x": 28, "fl_y": 28)", -5, -4, false},
        {R"("fl_x": 28, "fl_y": 28)", -5, 6, false},
        // Beyond the field, where the polynomial comes back to the picture's middle.
        {R"("camera_model": "OPENCV", "k1": -0.25, "fl_x": 28, "fl_y": 28)", -5, 4, false},
        {R"("camera_model": "OPENCV_FISHEYE", "fl_x": 18, "fl_y": 18)", 1, -4, false},
        {R"("camera_model": "OPENCV_FISHEYE", "k1": -0.09, "fl_x": 18, "fl_y": 18)", 0.5, -4,
         false},
    };
    for (const Case& c : cases) {
        write_text(folder / "transforms.json", fmt::format(R"({{"w": 60, "h": 60, {},
            "frames": [{{"file_path": "a.png",
            "transform_matrix": [[1,0,0,{}], [0,1,0,0.5], [0,0,1,{}], [0,0,0,1]]}}]}})",
                                                           c.lens, c.x, c.z));
        fs::remove_all(folder / "scene");
        const Outcome made = run("new --mesh model.obj --views transforms.json -o scene");
        EXPECT_EQ(made.code, 0) << made.err;
        EXPECT_EQ(contains(made.err, "lies in 0 of 1 pictures"), !c.is_inside) << c.lens << c.z;
    }
}

TEST_F(NewSceneTest, SaysWhereTheCameraHasOtherPixelsThanThePicture) {
    std::string views = transforms_at(5);
    const std::string focal = R"("fl_y": 60)";
    views.replace(views.find(focal), focal.size(), R"("fl_y": 72.5)");
    write_text(folder / "transforms.json", views);
    const Outcome made = run("new --mesh model.obj --views transforms.json -o scene");
    EXPECT_EQ(made.code, 0) << made.err;
    EXPECT_TRUE(contains(made.err, "the first picture's focal lengths are 60 and 72.5 pixels"))
        << made.err;
}

TEST_F(NewSceneTest, SaysWhereMeshAndCamerasHaveOtherUnits) {
    write_text(folder / "transforms.json", transforms_at(5));
    const std::string text = kObj, rest = text.substr(text.find("vt"));
    const std::tuple<const char*, std::string, const char*> cases[] = {
        {"around", "v -9 -9 -9\nv 9 -9 -9\nv 9 9 9\nv -9 9 9\n" + rest,
         "transforms.json: 1 of 1 cameras lie within the box of the mesh"},
        {"tiny", obj_of_size(0.01),
         "transforms.json: 1 of 1 cameras see the mesh smaller than 2 %"}};
    for (const auto& [name, mesh, complaint] : cases) {
        write_text(folder / "unit.obj", mesh);
        const Outcome made =
            run(std::string("new --mesh unit.obj --views transforms.json -o ") + name);
        EXPECT_EQ(made.code, 0) << made.err;
        EXPECT_TRUE(contains(made.err, complaint)) << made.err;
    }
}

TEST_F(NewSceneTest, NamesOfFilesEndBeforeTheyAreTooLong) {
    const std::string name(250, 'm');
    fs::copy(obj, folder / (name + ".obj"));
    const Outcome made = run("new --mesh " + name + ".obj -o scene");
    ASSERT_EQ(made.code, 0) << made.err;
    EXPECT_TRUE(fs::exists(folder / "scene/meshes" / (name.substr(0, 200) + ".ply")));
}

TEST_F(NewSceneTest, WritesIntoAFolderThatIsThere) {
    fs::create_directory(folder / "here");
    fs::permissions(folder / "here", fs::perms::set_gid, fs::perm_options::add);
    const std::string in_it = "cd '" + (folder / "here").string() +
                              "' && '" BURNISH_BINARY "' new --mesh ../model.obj -o . 2>/dev/null" +
                              " && test -e scene.xml";
    EXPECT_EQ(std::system(in_it.c_str()), 0) << "the folder that the shell is in has been replaced";
    EXPECT_NE(fs::status(folder / "here").permissions() & fs::perms::set_gid, fs::perms::none);

    fs::create_directories(folder / "linked/.burnish-unfinished/meshes");
    write_text(folder / "linked/.burnish-unfinished/meshes/old.ply",
               "of a command that was killed");
    fs::create_directory_symlink("linked", folder / "link");
    fs::create_directory(folder / "link.unfinished");
    write_text(folder / "link.unfinished/notes.txt", "mine");
    EXPECT_EQ(run("new --mesh model.obj -o link").code, 0);
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
    EXPECT_TRUE(fs::exists(folder / "linked/scene.xml"));
    EXPECT_FALSE(fs::exists(folder / "linked/meshes/old.ply"));
    EXPECT_FALSE(fs::exists(folder / "linked/.burnish-unfinished"));
    EXPECT_EQ(read_text(folder / "link.unfinished/notes.txt"), "mine");
}

TEST_F(NewSceneTest, RefusesWhatItCannotUseAndLeavesNothing) {
    write_text(folder / "bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const std::string faces = "vt 0 0\nf 1/1 2/1 3/1\n";
    write_text(folder / "far.obj", "v 0 0 0\nv 9e11 0 0\nv 0 1 0\n" + faces);
    write_text(folder / "point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\n" + faces);
    write_text(folder / "tiny.obj", "v 0 0 0\nv 1e-44 0 0\nv 0 1e-44 0\n" + faces);
    write_text(folder / "model.fbx", "x");
    write_text(folder / "model.gltf", "{}");
    write_text(folder / "bad.hdr", "damaged\n");
    fs::create_directory(folder / "full");
    write_text(folder / "full/notes.txt", "mine");
    const std::pair<std::string, std::string> cases[] = {
        {"--mesh bare.obj -o out", "bare.obj: found no texture coordinates"},
        {"--mesh far.obj -o out",
         "burnish: far.obj: a vertex is at (9e+11, 0, 0), expected it within 1e+11 of the origin"},
        {"--mesh point.obj -o out", "burnish: point.obj: all vertices are at one place"},
        {"--mesh tiny.obj -o out", "burnish: tiny.obj: all vertices are at one place, or almost, "},
        {"--mesh model.fbx -o out", "expected a mesh: .obj, .ply or .glb"},
        {"--mesh model.gltf -o out", "export it as .glb"},
        {"--mesh missing.obj -o out", "missing.obj"},
        {"--mesh model.obj -o full", "a folder that does not exist yet, or an empty one"},
        {"--mesh missing.obj -o full", "a folder that does not exist yet, or an empty one"},
        {"--mesh model.obj --environment model.ply -o out",
         "model.ply: expected the sky as HDR, EXR or PFM"},
        {"--mesh model.obj --environment bad.hdr -o out", "burnish: bad.hdr: "},
        {"--mesh model.obj -o out --texture-size 0", "--texture-size"},
        {"--mesh model.obj -o out --texture-size 8193",
         "--texture-size: expected a whole number from 1 to 8192"},
        {"--mesh model.obj -o out --up x", "--up: expected y or z, found 'x'"},
        {"--mesh model.obj -o out --views transforms.json --up z",
         "--up has no effect with --views: it needs --environment"},
        {"-o out", "--mesh"}};
    for (const auto& [arguments, text] : cases) {
        const Outcome outcome = run("new " + arguments);
        EXPECT_NE(outcome.code, 0) << arguments;
        EXPECT_TRUE(contains(outcome.err, text)) << arguments << ": " << outcome.err;
        EXPECT_FALSE(fs::exists(folder / "out")) << arguments;
    }
    EXPECT_EQ(run("new --mesh model.obj -o full").code, 73);
    EXPECT_EQ(read_text(folder / "full/notes.txt"), "mine");
}

Mesh cube() { return mitsuba::unit_cube(); }

/// Each face in a cell of its own of the texture.
Mesh unwrapped_cube() {
    Mesh mesh = cube();
    for (std::size_t v = 0; v < mesh.uvs.size(); ++v) {
        const auto face = static_cast<float>(v / 4);
        mesh.uvs[v] = {(face + mesh.uvs[v].x) / 6, mesh.uvs[v].y};
    }
    return mesh;
}

TEST(MeshCheck, FindsNothingWrongWithAnUnwrappedCube) {
    const MeshCheck check = check_mesh(unwrapped_cube(), 60);
    EXPECT_EQ(check.triangles, 12u);
    EXPECT_EQ(check.used_share, 1);
    EXPECT_EQ(check.overlapping_share, 0);
    EXPECT_TRUE(check.is_closed);
    EXPECT_NEAR(check.volume, 8, 1e-6);
    EXPECT_EQ(complaints(check), std::vector<std::string>{});
}

/// In texels: whether a point lies within the triangle, which may be clockwise.
bool lies_within(const Mesh& mesh, const Triangle& t, double x, double y, int width, int height) {
    const auto side_of = [&](std::size_t i) {
        const Vec2f a = mesh.uvs[t.vertex[i]], b = mesh.uvs[t.vertex[(i + 1) % 3]];
        const double ax = double{a.x} * width, ay = double{a.y} * height;
        return (double{b.x} * width - ax) * (y - ay) - (double{b.y} * height - ay) * (x - ax);
    };
    const double s = side_of(0), u = side_of(1), v = side_of(2);
    return (s > 0 && u > 0 && v > 0) || (s < 0 && u < 0 && v < 0);
}

TEST(MeshCheck, CoversAreThoseOfEachTexelsCentre) {
    constexpr int kWidth = 37, kHeight = 21;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> anywhere(-0.7f, 1.3f), little(-0.03f, 0.03f);
    for (int round = 0; round < 400; ++round) {
        Mesh mesh;
        mesh.triangles = {{{0, 1, 2}}};
        const Vec2f first{anywhere(random), anywhere(random)};
        for (int i = 0; i < 3; ++i)  // large ones, small ones and thin ones
            mesh.uvs.push_back({round % 2 == 0 ? anywhere(random) : first.x + little(random),
                                round % 4 < 2 ? anywhere(random) : first.y + little(random)});
        UvCovers covers = make_covers(kWidth, kHeight), expected = covers;
        add_covers(mesh, {}, covers);
        for (int y = -kHeight; y < 2 * kHeight; ++y)
            for (int x = -kWidth; x < 2 * kWidth; ++x) {
                const int texel = (y + kHeight) % kHeight * kWidth + (x + kWidth) % kWidth;
                auto& count = expected.count[static_cast<std::size_t>(texel)];
                if (count < 2 &&
                    lies_within(mesh, mesh.triangles[0], x + 0.5, y + 0.5, kWidth, kHeight))
                    ++count;
            }
        EXPECT_EQ(covers.count, expected.count) << round;
    }
}

/// However often across.
TEST(MeshCheck, TrianglesMayRepeatTheTexture) {
    constexpr int kWidth = 11, kHeight = 7, kMax = 6;
    std::mt19937 random(4);
    std::uniform_real_distribution<float> across(-kMax, kMax), along(-0.5f, 1.4f);
    for (int round = 0; round < 300; ++round) {
        Mesh mesh;
        mesh.triangles = {{{0, 1, 2}}};
        for (int i = 0; i < 3; ++i) mesh.uvs.push_back({across(random), along(random)});
        UvCovers covers = make_covers(kWidth, kHeight), expected = covers;
        add_covers(mesh, {}, covers);
        for (int y = -kHeight; y < 2 * kHeight; ++y)
            for (int x = -kMax * kWidth; x < kMax * kWidth; ++x) {
                const int texel = (y + kHeight) % kHeight * kWidth + (x + kMax * kWidth) % kWidth;
                auto& count = expected.count[static_cast<std::size_t>(texel)];
                count += count < 2 &&
                         lies_within(mesh, mesh.triangles[0], x + 0.5, y + 0.5, kWidth, kHeight);
            }
        EXPECT_EQ(covers.count, expected.count) << round;
    }
    for (const float times : {3.0f, 1e3f, 1e9f, 1e30f}) {
        Mesh square;
        square.uvs = {{0, 0}, {times, 0}, {times, times}, {0, times}};
        square.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
        UvCovers covers = make_covers(kWidth, kHeight);
        add_covers(square, {}, covers);
        EXPECT_EQ(covers.count, std::vector<unsigned char>(kWidth * kHeight, 2)) << times;
    }
}

/// 10^11 texels.
TEST(MeshCheck, FacesThatEachFillTheTextureAreCountedSoon) {
    Mesh mesh;
    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (int i = 0; i < 100'000; ++i) {
        mesh.triangles.push_back({{0, 1, 2}});
        mesh.triangles.push_back({{0, 2, 3}});
    }
    UvCovers covers = make_covers(1024, 1024);
    const std::clock_t begin = std::clock();
    add_covers(mesh, {}, covers);
    EXPECT_LT(std::clock() - begin, 5 * CLOCKS_PER_SEC);
    EXPECT_EQ(shares_of(covers).overlapping, 1);
}

/// 2 * 10^10 texels.
TEST(MeshCheck, FacesThatShareHalfOfTheTextureAreCountedSoon) {
    Mesh mesh;
    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}};
    mesh.triangles.assign(2000, {{0, 1, 2}});
    UvCovers covers = make_covers(4096, 4096);
    const std::clock_t begin = std::clock();
    add_covers(mesh, {}, covers);
    EXPECT_LT(std::clock() - begin, 5 * CLOCKS_PER_SEC);
    EXPECT_EQ(shares_of(covers).overlapping, 1);
}

/// An edge along a row of centres belongs to one of its triangles; one of no height covers nothing.
TEST(MeshCheck, AnEdgeThroughCentresIsCountedOnce) {
    Mesh mesh;
    mesh.uvs = {{0, 0}, {1, 0}, {1, 0.5f}, {0, 0.5f}, {1, 1}, {0, 1}};
    mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}, {{3, 2, 4}}, {{3, 4, 5}}, {{3, 3, 3}}, {{3, 2, 3}}};
    UvCovers covers = make_covers(21, 21);  // 0.5 is the centre of a row
    add_covers(mesh, {}, covers);
    EXPECT_EQ(covers.count, std::vector<unsigned char>(21 * 21, 1));
}

std::string complaints_of(const Mesh& mesh) {
    std::string all;
    for (const std::string& text : complaints(check_mesh(mesh, 60))) all += text + "\n";
    return all;
}

TEST(MeshCheck, SaysWhatIsWrong) {
    EXPECT_TRUE(contains(complaints_of(cube()), "100.0 % of the used texels are read by several"));

    Mesh inward = unwrapped_cube();
    for (Triangle& t : inward.triangles) std::swap(t.vertex[1], t.vertex[2]);
    EXPECT_TRUE(contains(complaints_of(inward), "look inwards"));
    EXPECT_TRUE(contains(complaints_of(inward), "12 of 12 triangles have normals that look to"));
    for (Vec3f& n : inward.normals) n = -n;
    EXPECT_FALSE(contains(complaints_of(inward), "normals that look"));

    Mesh open = inward;
    open.triangles.pop_back();
    EXPECT_FALSE(contains(complaints_of(open), "inwards"));

    Mesh flat = unwrapped_cube();
    for (std::size_t v = 0; v < 4; ++v)
        flat.uvs[v] = {0.1f, 0.1f}, flat.positions[v + 4] = {0, 0, 0};
    EXPECT_TRUE(contains(complaints_of(flat), "2 of 12 triangles have no area in the texture"));
    EXPECT_TRUE(contains(complaints_of(flat), "2 of 12 triangles have no area\n"));

    Mesh small = unwrapped_cube();
    for (Vec2f& uv : small.uvs) uv = uv * 0.08f;
    EXPECT_TRUE(contains(complaints_of(small), "all charts together lie on 0.69 % of the texture"));
    for (Vec2f& uv : small.uvs) uv = {};
    EXPECT_FALSE(contains(complaints_of(small), "all charts together"));

    Mesh outside = unwrapped_cube();
    for (std::size_t v = 0; v < 4; ++v) outside.uvs[v].y += 1;
    EXPECT_TRUE(contains(complaints_of(outside), "2 of 12 triangles leave the unit square"));
    EXPECT_EQ(check_mesh(outside, 60).overlapping_share, 0);

    for (const float scale : {1e-4f, 1e5f}) {
        Mesh other = unwrapped_cube();
        for (Vec3f& p : other.positions) p = p * scale;
        EXPECT_TRUE(contains(complaints_of(other), "units large"));
    }
}

TEST(MeshCheck, SaysWhereRaysBeginVisiblyOffAMesh) {
    const auto moved = [](float by) {
        Mesh mesh = unwrapped_cube();
        for (Vec3f& p : mesh.positions) p.y -= by;
        return complaints_of(mesh);
    };
    EXPECT_EQ(moved(200), "");
    EXPECT_TRUE(contains(moved(999),
                         "lies 500 times its own size from the origin, where rays "
                         "begin up to 0.089 off its surface: move it"))
        << moved(999);
    Mesh small = unwrapped_cube();
    for (Vec3f& p : small.positions) p = p * 0.001f;
    EXPECT_TRUE(contains(complaints_of(small),
                         "is 0.002 units large, and rays begin 8.9e-05 off its surface: scale"))
        << complaints_of(small);
}

TEST_F(NewSceneTest, SaysWhatAGlbLacks) {
    const Document right = Gltf().document;
    EXPECT_EQ(complaint(right), "");
    const auto changed = [&](const char* place, const Document& value) {
        Document document = right;
        document[Document::json_pointer(place)] = value;
        return complaint(document);
    };
    const std::tuple<const char*, Document, const char*> cases[] = {
        {"/nodes/1/children",
         {0},
         "nodes[1].children[0]: found 0, expected a node that nothing else"},
        {"/nodes/1/mesh", 4, "nodes[1].mesh: found 4, expected a whole number from 0 to 0"},
        {"/scene", 1, "scene: found 1"},
        {"/accessors/0/count", 7, "elements within the 72 bytes"},
        {"/accessors/0/count", 1e300, "accessors[0].count: found"},
        {"/accessors/0/type", "VEC2", "\"VEC3\""},
        {"/accessors/0/componentType", 5124, "5120 to 5123"},
        {"/accessors/0/sparse", Document::object(), "not sparse"},
        {"/accessors/1/count", 5, "6 elements, as POSITION has"},
        {"/bufferViews/0/byteLength", 1000, "a part of the"},
        {"/bufferViews/0/byteOffset", -4, "a whole number"},
        {"/bufferViews/0/byteStride", 4, "elements within"},
        {"/meshes/0/primitives/0/mode", 7, "mode: found 7"},
        {"/meshes/0/primitives/0/mode", 0, "a scene with triangles"},
        {"/nodes/1/scale", {0, 1, 1}, "a transform that has an inverse"},
        {"/nodes/1/matrix", {1, 2}, "an array of 16 numbers"},
        {"/nodes/1/rotation",
         {0, 0, 1, 1},
         "nodes[1].rotation: found [0,0,1,1], expected a quaternion of length 1"},
        {"/nodes/1/rotation", {0, 0, 0, 0}, "expected a quaternion of length 1"},
        {"/nodes", 3, "nodes: found 3, expected an array"},
        {"/buffers/0/uri", "model.bin",
         "buffers[0].uri: found \"model.bin\", expected the data in the file's own chunk"},
        {"/extensionsRequired", {"EXT_meshopt_compression"}, "export it without compression"},
        {"/extensionsRequired",
         {"EXT_mesh_gpu_instancing"},
         "a file without this extension, which is not read"}};
    for (const auto& [place, value, text] : cases)
        EXPECT_TRUE(contains(changed(place, value), text))
            << place << ": " << changed(place, value);
    Document far = right;
    far["nodes"][0]["scale"] = {1e6, 1e6, 1e6};
    EXPECT_EQ(complaint(far), "");
    far["nodes"][1]["scale"] = {1e6, 1e6, 1e6};
    EXPECT_TRUE(contains(complaint(far), "model.glb: nodes[1]: found {")) << complaint(far);
    EXPECT_TRUE(contains(complaint(far), "expected vertices within 1e+11 of the origin"));
    far["nodes"][1]["scale"] = {1e40, 1e40, 1e40};
    EXPECT_TRUE(contains(complaint(far), "expected vertices within 1e+11 of the origin"));
    std::string data = Gltf().data.bytes;
    const float nan = std::nanf("");
    std::memcpy(data.data() + 8, &nan, 4);
    EXPECT_TRUE(contains(complaint(right, data), "finite numbers; element 0 is not"));
    data = Gltf().data.bytes;
    data[data.size() - 1] = 9;
    EXPECT_TRUE(contains(complaint(right, data), "indices below 6; number 5 is 9"));
}

TEST_F(NewSceneTest, NamesThePrimitiveOfAGlbWithoutTextureCoordinates) {
    Document document = Gltf().document;
    Document floor = document["meshes"][0];
    floor["name"] = "Floor";
    floor["primitives"][0]["attributes"].erase("TEXCOORD_0");
    document["meshes"].push_back(floor);
    document["nodes"].push_back({{"mesh", 1}});
    document["nodes"][0]["children"].push_back(2);
    EXPECT_TRUE(contains(complaint(document),
                         "model.glb: meshes[1].primitives[0] (\"Floor\") has no TEXCOORD_0"))
        << complaint(document);
}

TEST_F(NewSceneTest, ReadsAGlbThatRequiresExtensionsWithoutMeaningForAMesh) {
    Document document = Gltf().document;
    for (const char* extension :
         {"KHR_mesh_quantization", "KHR_lights_punctual", "KHR_materials_variants"}) {
        document["extensionsRequired"] = {extension};
        EXPECT_EQ(complaint(document), "") << extension;
    }
}

/// Lets an accessor show so many elements of a part of the buffer that was added.
void show(Gltf& gltf, std::size_t accessor, int view, std::size_t count) {
    gltf.document["bufferViews"] = gltf.data.views;
    gltf.document["buffers"][0]["byteLength"] = gltf.data.bytes.size();
    gltf.document["accessors"][accessor]["bufferView"] = view;
    gltf.document["accessors"][accessor]["count"] = count;
}

/// Primitives that share their accessors: a small file of many triangles.
TEST_F(NewSceneTest, TrianglesOfAGlbAreBounded) {
    constexpr int kCorners = 50'000;
    Gltf many;
    const int strip = many.data.add(std::vector<std::uint8_t>(kCorners));
    Document& document = many.document;
    show(many, 2, strip, kCorners);
    Document& primitives = document["meshes"][0]["primitives"];
    primitives[0]["mode"] = 5;
    const Document first = primitives[0];
    for (int i = 0; i < 21; ++i) primitives.push_back(first);
    EXPECT_TRUE(contains(complaint(document, many.data.bytes), "at most 1000000 vertices in all"))
        << complaint(document, many.data.bytes);
    for (Document& primitive : primitives) primitive["attributes"]["NORMAL"] = 0;
    EXPECT_TRUE(contains(complaint(document, many.data.bytes), "at most 1000000 triangles in all"))
        << complaint(document, many.data.bytes);
}

/// Primitives that share a large accessor, of which each shows two triangles.
TEST_F(NewSceneTest, VerticesThatAGlbReadsAreBounded) {
    constexpr std::size_t kVertices = 2000;
    Gltf many;
    const int positions = many.data.add(std::vector<float>(3 * kVertices));
    Document& document = many.document;
    show(many, 0, positions, kVertices);
    Document& primitives = document["meshes"][0]["primitives"];
    primitives[0]["attributes"].erase("TEXCOORD_0");
    const Document first = primitives[0];
    for (int i = 0; i < 600; ++i) primitives.push_back(first);
    const std::string found = complaint(document, many.data.bytes);
    EXPECT_TRUE(contains(found, "primitives[500]: found")) << found;
    EXPECT_TRUE(contains(found, "at most 1000000 vertices in all")) << found;
}

/// Points that many nodes show.
TEST_F(NewSceneTest, PrimitivesOfAGlbAreBounded) {
    Document document = Gltf().document;
    Document& primitives = document["meshes"][0]["primitives"];
    const Document points = {{"attributes", Document::object()}, {"mode", 0}};
    primitives = Document::array();
    for (int i = 0; i < 1000; ++i) primitives.push_back(points);
    for (int i = 0; i < 1100; ++i) {
        document["scenes"][0]["nodes"].push_back(document["nodes"].size());
        document["nodes"].push_back({{"mesh", 0}});
    }
    const std::string found = complaint(document);
    EXPECT_TRUE(contains(found, "at most 1000000 primitives in all")) << found;
}

TEST_F(NewSceneTest, WarningsNameTheFilesThatAreLeft) {
    Image sky = make_image(8, 4, 3, 2.0f);
    sky.values[5] = std::nanf("");
    write_image(folder / "sky.exr", sky);
    const Outcome made = run("new --mesh model.obj --environment sky.exr -o scene");
    ASSERT_EQ(made.code, 0) << made.err;
    EXPECT_TRUE(contains(made.err, "scene/scene.xml:")) << made.err;
    EXPECT_TRUE(contains(made.err, "not finite")) << made.err;
    EXPECT_FALSE(contains(made.err, "unfinished")) << made.err;
}

/// Whatever a file holds, it is a mesh or a sentence.
TEST_F(NewSceneTest, DamagedFilesNeverCrash) {
    const std::string files[] = {kPlyOfCorners, Gltf().bytes()};
    const fs::path names[] = {folder / "damaged.ply", folder / "damaged.glb"};
    std::mt19937 random(1);
    std::size_t refused = 0;
    for (std::size_t kind = 0; kind < 2; ++kind)
        for (int i = 0; i < 600; ++i) {
            std::string bytes = files[kind];
            if (i % 3 == 0) bytes.resize(random() % bytes.size());
            for (int k = 0; k < i % 4 && !bytes.empty(); ++k)
                bytes[random() % bytes.size()] = static_cast<char>(random());
            write_text(names[kind], bytes);
            try {
                const Mesh mesh = read_mesh(names[kind]).mesh;
                for (const Triangle& t : mesh.triangles)
                    for (const std::uint32_t v : t.vertex) ASSERT_LT(v, mesh.positions.size());
                if (!mesh.uvs.empty()) complaints(check_mesh(mesh, 16));
            } catch (const InputError& e) {
                ++refused;
                EXPECT_TRUE(contains(e.what(), "damaged.")) << e.what();
            }
        }
    EXPECT_GT(refused, 300u);
}

}  // namespace
}  // namespace burnish
