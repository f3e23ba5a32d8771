// PLY and OBJ files of every kind, damaged ones, and what transforms do to normals.
#include <gtest/gtest.h>

#include <bit>
#include <cstring>

#include "core/random.h"
#include "error_of.h"
#include "mitsuba/mesh.h"
#include "mitsuba/obj.h"
#include "mitsuba/ply.h"
#include "mitsuba/temporary_scene.h"
#include "paths/triangles.h"

namespace burnish {
namespace {

using namespace mitsuba;

/// Appends a number of `size` bytes in the byte order of the file.
void put(std::string& bytes, std::uint64_t bits, int size, bool big_endian) {
    for (int i = 0; i < size; ++i)
        bytes += static_cast<char>(bits >> (8 * (big_endian ? size - 1 - i : i)));
}
void put_float(std::string& bytes, float v, bool big_endian) {
    put(bytes, std::bit_cast<std::uint32_t>(v), 4, big_endian);
}

/// A quad and a triangle over five vertices, with properties, lists and an element that nobody
/// reads.
std::string binary_ply(bool big_endian) {
    std::string bytes =
        std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
        "_endian 1.0\r\ncomment x\nelement camera 1\nproperty double angle\nelement vertex 5\n"
        "property uchar quality\nproperty double x\nproperty float y\nproperty float z\n"
        "property list uchar short tags\nproperty float texture_u\nproperty float texture_v\n"
        "element face 2\nproperty int group\nproperty list ushort uint vertex_index\n"
        "property list uchar float texcoord\nend_header\n";
    put(bytes, std::bit_cast<std::uint64_t>(1.5), 8, big_endian);
    const float kPoints[5][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 3, 1}};
    for (int i = 0; i < 5; ++i) {
        put(bytes, 200, 1, big_endian);
        put(bytes, std::bit_cast<std::uint64_t>(static_cast<double>(kPoints[i][0])), 8, big_endian);
        put_float(bytes, kPoints[i][1], big_endian);
        put_float(bytes, kPoints[i][2], big_endian);
        put(bytes, static_cast<unsigned>(i), 1, big_endian);
        for (int tag = 0; tag < i; ++tag) put(bytes, 7, 2, big_endian);
        put_float(bytes, kPoints[i][0] / 4, big_endian);
        put_float(bytes, kPoints[i][1] / 4, big_endian);
    }
    for (const auto& face : std::vector<std::vector<unsigned>>{{0, 1, 2, 3}, {3, 2, 4}}) {
        put(bytes, 9, 4, big_endian);
        put(bytes, face.size(), 2, big_endian);
        for (const unsigned index : face) put(bytes, index, 4, big_endian);
        put(bytes, 1, 1, big_endian);
        put_float(bytes, 0.5f, big_endian);
    }
    return bytes;
}

const std::string kAsciiPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "property float nx\nproperty float ny\nproperty float nz\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 "
    "0 1 2\n";

const std::string kObj =
    "# quad and triangle\nmtllib none.mtl\no thing\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 1 3 "
    "1\nvt 0 0\nvt 1 0.25\n"
    "usemtl red\ns 1\nf 1/1 2/2 3/2 4/1\nf -2/-1 -3/-1 -1/-2\n";

std::vector<std::array<std::uint32_t, 3>> indices(const Mesh& mesh) {
    std::vector<std::array<std::uint32_t, 3>> all;
    for (const Triangle& t : mesh.triangles) all.push_back(t.vertex);
    return all;
}

Mesh read_ply(const std::filesystem::path& file) { return read_ply_file(file).mesh; }
Mesh read_obj(const std::filesystem::path& file) { return read_obj_file(file).mesh; }

template <class Read>
std::string message_of(Read read, const std::filesystem::path& file) {
    return test::error_of([&] {
        const Mesh mesh = read(file);
        for (const Triangle& t : mesh.triangles)
            for (const std::uint32_t v : t.vertex) EXPECT_LT(v, mesh.positions.size());
    });
}

TEST(Ply, BinaryOfEitherByteOrderWithExtraProperties) {
    const TemporaryFolder folder;
    for (const bool big_endian : {false, true}) {
        const Mesh mesh = read_ply(write_text(folder, "a.ply", binary_ply(big_endian)));
        ASSERT_EQ(mesh.positions.size(), 5u);
        EXPECT_EQ(mesh.positions[4], (Vec3f{1, 3, 1}));
        EXPECT_EQ(mesh.uvs[2].x, 0.5f);
        EXPECT_EQ(mesh.uvs[4].y, 0.75f);
        EXPECT_TRUE(mesh.normals.empty());
        EXPECT_EQ(indices(mesh),
                  (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}, {3, 2, 4}}));
    }
}

TEST(Ply, AsciiWithNormals) {
    const TemporaryFolder folder;
    const Mesh mesh = read_ply(write_text(folder, "a.ply", kAsciiPly));
    EXPECT_EQ(mesh.normals.size(), 3u);
    EXPECT_EQ(mesh.positions[1], (Vec3f{1, 0, 0}));
    EXPECT_EQ(indices(mesh), (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}}));
}

TEST(Ply, MessagesSayWhere) {
    const TemporaryFolder folder;
    const auto expect = [&](std::string text, const std::string& from, const std::string& to,
                            const std::string& message) {
        const std::size_t at = text.find(from);
        ASSERT_NE(at, std::string::npos);
        const auto file = write_text(folder, "a.ply", text.replace(at, from.size(), to));
        const std::string error = message_of(read_ply, file);
        EXPECT_EQ(error.rfind(file.string() + message, 0), 0u) << error;
    };
    expect(kAsciiPly, "3 0 1 2", "3 0 1 3",
           ":16: found the vertex index 3, expected one in [0, 2]");
    expect(kAsciiPly, "3 0 1 2", "3 0 -1 2",
           ":16: found the vertex index -1, expected one in [0, 2]");
    expect(kAsciiPly, "3 0 1 2", "2 0 1", ":16: found a face of 2 vertices, expected at least 3");
    expect(kAsciiPly, "1 0 0 0 0 1", "1 zero 0 0 0 1", ":14: found \"zero");
    expect(kAsciiPly, "1 0 0 0 0 1", "1 +-1 0 0 0 1", ":14: found \"+-1");
    for (const auto& [number, found] : std::vector<std::pair<std::string, std::string>>{
             {"nan", "nan"}, {"1e999", "inf"}, {"-1e999", "-inf"}, {"1e39", "1e+39"}})
        expect(kAsciiPly, "1 0 0 0 0 1", number + " 0 0 0 0 1",
               ":14: found " + found + ", expected a finite float");
    expect(kAsciiPly, "vertex 3", "vertex 2000000000",
           ":12: the header says 2000000000 vertex rows of at least 12 bytes");
    expect(kAsciiPly, "property float z\n", "", ":12: the vertices lack x, y or z");
    expect(kAsciiPly, "float x", "quad x", ":4: found the type \"quad\", expected a PLY type");
    expect(kAsciiPly, "format ascii 1.0\n", "", ":11: the header has no format line");
    expect(kAsciiPly, "ply\n", "plx\n", ":1: found no \"ply\" line");
    expect(kAsciiPly, "element face 1", "element face 0", ":15: found no faces");
    expect(
        "ply\nformat ascii 1.0\nelement face 1\nproperty list int int vertex_index\n"
        "end_header\n3 0 1 2\n",
        "", "", ":6: found no vertices before the faces, expected them first");
    std::string binary = binary_ply(false);
    const std::size_t first_y = binary.find("end_header\n") + 11 + 8 + 1 + 8;
    std::memset(binary.data() + first_y, 0xff, 4);
    expect(binary, "", "",
           ": byte offset " + std::to_string(first_y) + ": found -nan, expected a finite float");
    binary = binary_ply(false);
    binary.resize(binary.size() - 3);
    const auto file = write_text(folder, "b.ply", binary);
    EXPECT_EQ(message_of(read_ply, file), file.string() + ": byte offset " +
                                              std::to_string(binary.size() - 1) +
                                              ": the file ends too early, expected 4 more bytes");
}

/// One face with so many corners and values of its own.
std::string polygon_ply(int corners, const std::vector<std::string>& properties) {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
        "float z\nelement face 1\nproperty list uint int vertex_indices\n";
    for (const std::string& name : properties) text += "property float " + name + "\n";
    text += "end_header\n0 0 0\n1 0 0\n0 1 0\n" + std::to_string(corners);
    for (int i = 0; i < corners; ++i) text += " " + std::to_string(i % 3);
    for (std::size_t i = 0; i < properties.size(); ++i) text += " " + std::to_string(i);
    return text + "\n";
}

TEST(Ply, AttributesOfAFaceAreThoseOfItsTriangles) {
    const TemporaryFolder folder;
    const MeshFile read =
        read_ply_file(write_text(folder, "a.ply", polygon_ply(100, {"r", "g", "b"})), {});
    ASSERT_EQ(read.mesh.triangles.size(), 98u);
    ASSERT_EQ(read.attributes.size(), 1u);
    ASSERT_EQ(read.attributes[0].values.size(), 3 * 98u);
    for (std::size_t i = 0; i < 3 * 98u; ++i)
        EXPECT_EQ(read.attributes[0].values[i], static_cast<float>(i % 3));
}

TEST(Ply, ManyValuesOfALargePolygonAreRefused) {
    const TemporaryFolder folder;
    std::vector<std::string> properties;
    for (int i = 0; i < 40; ++i) properties.push_back("a" + std::to_string(i) + "_x");
    const auto file = write_text(folder, "a.ply", polygon_ply(30'000, properties));
    EXPECT_EQ(message_of(read_ply, file),
              file.string() +
                  ":53: the attributes of the faces have 1199920 values, one for each "
                  "triangle, expected at most 1000000");
}

TEST(Obj, SharesVerticesAndMakesFans) {
    const TemporaryFolder folder;
    const Mesh mesh = read_obj(write_text(folder, "a.obj", kObj));
    // Corner 3 has another texture coordinate than 4 -> vertices 4/1 and 4/2 are two.
    EXPECT_EQ(indices(mesh),
              (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}, {4, 2, 5}}));
    EXPECT_EQ(mesh.positions[5], (Vec3f{1, 3, 1}));
    EXPECT_EQ(mesh.uvs[4].y, 0.25f);
    EXPECT_TRUE(mesh.normals.empty());
}

/// The last two corners: on an edge but for rounding, and out of the plane.
TEST(Polygon, IsConvexWhereItTurnsOneWay) {
    const std::vector<Vec3f> positions{{0, 0, 1},    {2, 0, 1},          {2, 2, 1},   {0, 2, 1},
                                       {1.5f, 1, 1}, {1, 0.9999999f, 1}, {3, 1, 1.5f}};
    using Polygon = std::vector<std::uint32_t>;
    for (const Polygon& p :
         {Polygon{0, 1, 2, 3}, {3, 2, 1, 0}, {0, 1, 2}, {0, 1, 2, 5}, {0, 1, 6, 2, 3}})
        EXPECT_TRUE(is_convex(positions, p)) << p.size();
    for (const Polygon& p : {Polygon{0, 1, 2, 3, 4}, {4, 3, 2, 1, 0}, {2, 3, 4, 0, 1}})
        EXPECT_FALSE(is_convex(positions, p)) << p.front();
}

TEST(Obj, AByteOrderMarkIsNoPartOfTheFirstLine) {
    const TemporaryFolder folder;
    const Mesh mesh = read_obj(
        write_text(folder, "a.obj", "\xEF\xBB\xBFv -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\n"));
    ASSERT_EQ(mesh.positions.size(), 3u);
    EXPECT_EQ(mesh.positions[0], (Vec3f{-1, -1, 0}));
}

TEST(Obj, CommentsMayEndAnyLine) {
    const TemporaryFolder folder;
    const Mesh mesh = read_obj(write_text(
        folder, "a.obj",
        "v -1 -1 0 # 1\nv 1 -1 0# 2 3\r\nv 1 1 0 #\nvt 0.5 0.25 # 7\nvn 0 0 1 # n\nf 1/1/1 "
        "2/1/1 3/1/1 # 4 5\n"));
    EXPECT_EQ(indices(mesh), (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}}));
    EXPECT_EQ(mesh.positions[1], (Vec3f{1, -1, 0}));
    EXPECT_EQ(mesh.uvs[0].y, 0.25f);
    EXPECT_EQ(mesh.normals[0].z, 1);
}

TEST(Obj, NamesOfMaterialsMayHaveASharpWithin) {
    const TemporaryFolder folder;
    const auto materials = [&](const std::string& first, const std::string& second) {
        return read_obj_file(write_text(folder, "a.obj",
                                        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nusemtl " + first +
                                            "\nf 1 2 3\n usemtl " + second + "\r\nf 1 2 3#4\n"))
            .materials;
    };
    EXPECT_EQ(materials("Material#1", "Material#2"), 2u);
    EXPECT_EQ(materials("Material#1", "Material#1 # of the back"), 1u);
    EXPECT_EQ(materials("red # 1", "red\t#2"), 1u);
}

/// Two squares side by side, of which only the first has texture coordinates or normals.
std::string two_squares(const std::string& given, const std::string& face) {
    return "v -1 -1 0\nv 0 -1 0\nv 0 1 0\nv -1 1 0\nv 1 -1 0\nv 1 1 0\n" + given + face +
           "f 2 5 6 3\n";
}

TEST(Obj, CornersKeepTheTextureCoordinatesThatTheyHave) {
    const TemporaryFolder folder;
    const MeshFile file = read_obj_file(
        write_text(folder, "a.obj",
                   two_squares("vt 0.1 0.1\nvt 0.2 0.1\nvt 0.2 0.2\n", "f 1/1 2/2 3/3 4/3\n")));
    ASSERT_EQ(file.mesh.uvs.size(), 8u);
    EXPECT_EQ(file.mesh.uvs[1].x, 0.2f);
    EXPECT_EQ(file.mesh.uvs[4].x, 0);
    EXPECT_EQ(file.corners_without_uv, 4u);
    EXPECT_EQ(file.corners_without_normal, 0u);
    EXPECT_TRUE(file.mesh.normals.empty());
}

/// Of a scene that shows the file a.obj.
std::vector<std::string> warnings_of_obj(const TemporaryFolder& folder,
                                         const std::string& flag = "") {
    return load_text(folder,
                     "<emitter type='constant'/><shape type='obj'><string name='filename' "
                     "value='a.obj'/>" +
                         flag + "</shape>")
        .warnings;
}

TEST(Obj, SlashesThatEndACornerSayNothing) {
    const TemporaryFolder folder;
    const auto read = [&](const std::string& face) {
        return read_obj_file(
            write_text(folder, "a.obj",
                       "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nvt 0.1 0.1\nvt 0.2 0.1\nvt 0.2 0.2\n"
                       "vn 0.6 0 0.8\nvn 0 0.6 0.8\nvn 0 0 1\n" +
                           face));
    };
    for (const auto& [slashed, plain] :
         {std::pair{"f 1/ 2/ 3/\n", "f 1 2 3\n"},
          {"f 1// 2// 3//\n", "f 1 2 3\n"},
          {"f 1/\t2//  3/ # 4\r\nf 1 3 4/", "f 1 2 3\nf 1 3 4\n"},
          {"f 1/2/ 2/3/ 3/1/\n", "f 1/2 2/3 3/1\n"},
          {"f 1/2/3/ 2/3/1/ 3//2/\n", "f 1/2/3 2/3/1 3//2\n"},
          {"f 1/1 2/2 3/3\nf 1/ 3/ 4/\n", "f 1/1 2/2 3/3\nf 1 3 4\n"}}) {
        const MeshFile found = read(slashed), expected = read(plain);
        EXPECT_EQ(found.mesh.positions, expected.mesh.positions) << slashed;
        EXPECT_EQ(found.mesh.uvs, expected.mesh.uvs) << slashed;
        EXPECT_EQ(found.mesh.normals, expected.mesh.normals) << slashed;
        EXPECT_EQ(indices(found.mesh), indices(expected.mesh)) << slashed;
    }
    EXPECT_EQ(read("f 1/1 2/2 3/3\nf 1/ 3/ 4/\n").corners_without_uv, 3u);
    EXPECT_THROW(read("f 1 2 3 //\n"), InputError);
    const auto message = message_of(
        read_obj, write_text(folder, "a.obj", "v 0 0 0\nf 1/ 1/ 1/\nusemtl a/ b/\nf 1/ 2/ 1/\n"));
    EXPECT_NE(message.find("a.obj:4: found the vertex index 2, but 1"), std::string::npos)
        << message;
}

TEST(Obj, CornersKeepTheNormalsThatTheyHave) {
    const TemporaryFolder folder;
    const auto path =
        write_text(folder, "a.obj", two_squares("vn 0.6 0 0.8\n", "f 1//1 2//1 3//1 4//1\n"));
    const MeshFile file = read_obj_file(path);
    ASSERT_EQ(file.mesh.normals.size(), 8u);
    EXPECT_EQ(file.mesh.normals[1], (Vec3f{0.6f, 0, 0.8f}));
    EXPECT_EQ(file.mesh.normals[4], (Vec3f{0, 0, 1}));
    EXPECT_EQ(file.corners_without_normal, 4u);
    ASSERT_EQ(warnings_of_obj(folder).size(), 1u);
    EXPECT_NE(
        warnings_of_obj(folder)[0].find("4 corners of the faces lack the normals that others have"),
        std::string::npos);
    EXPECT_TRUE(warnings_of_obj(folder, "<boolean name='face_normals' value='true'/>").empty());
}

TEST(MeshNormals, ThatAreZeroAreThoseOfTheFacesAround) {
    const TemporaryFolder folder;
    const std::string squares =
        "v -1 -1 0\nv 0 -1 0\nv 0 1 0\nv -1 1 0\nv 1 -1 0\nv 1 1 0\n"
        "v 9 9 9\nvn 0.6 0 0.8\nvn 0 0 0\nf 1//1 2//2 3//2 4//1\n"
        "f 2//2 5//1 6//1 3//2\n";
    const auto path = write_text(folder, "a.obj", squares);
    Mesh mesh = read_obj_file(path).mesh;
    EXPECT_EQ(fill_zero_normals(mesh), 2u);
    EXPECT_EQ(fill_zero_normals(mesh), 0u);
    std::size_t up = 0;
    for (const Vec3f& n : mesh.normals) {
        EXPECT_TRUE(n == (Vec3f{0, 0, 1}) || n == (Vec3f{0.6f, 0, 0.8f}));
        up += n == Vec3f{0, 0, 1};
    }
    EXPECT_EQ(up, 2u);
    ASSERT_EQ(warnings_of_obj(folder).size(), 1u);
    EXPECT_NE(warnings_of_obj(folder)[0].find("2 vertices have the normal 0 0 0"),
              std::string::npos);
    EXPECT_TRUE(warnings_of_obj(folder, "<boolean name='face_normals' value='true'/>").empty());
}

TEST(Obj, MessagesSayWhere) {
    const TemporaryFolder folder;
    const auto expect = [&](std::string text, const std::string& from, const std::string& to,
                            const std::string& message) {
        const auto file =
            write_text(folder, "a.obj", text.replace(text.find(from), from.size(), to));
        EXPECT_EQ(message_of(read_obj, file), file.string() + message);
    };
    expect(kObj, "4/1", "6/1", ":13: found the vertex index 6, but 5 were given so far");
    expect(kObj, "4/1", "4/3",
           ":13: found the texture coordinate index 3, but 2 were given so far");
    expect(kObj, "-1/-2", "-6/-2", ":14: found the vertex index -6, but 5 were given so far");
    expect(kObj, "f 1/1 2/2 3/2 4/1", "f 1/1 2/2",
           ":13: found a face of 2 vertices, expected at least 3");
    expect(kObj, "f 1/1 2/2 3/2 4/1", "f",
           ":13: found a face without vertices, expected at least 3");
    expect(kObj, "4/1", "99999999999999999999/1",
           ":13: found \"99999999999999999999/1\", expected whole numbers between slashes");
    expect(kObj, "4/1", "four/1", ":13: found \"four/1\", expected whole numbers between slashes");
    expect(kObj, "v 2 2 0", "v 2 two 0", ":6: found \"two\", expected a finite number");
    expect(kObj, "vt 1 0.25", "vt 1e999 0", ":10: found \"1e999\", expected a finite number");
    expect(kObj, "v 2 2 0", "v 2 -1e999 0", ":6: found \"-1e999\", expected a finite number");
    expect(kObj, "v 2 2 0", "v 2 +-2 0", ":6: found \"+-2\", expected a finite number");
    expect(kObj, "4/1", "4/+-1", ":13: found \"4/+-1\", expected whole numbers between slashes");
    expect(kObj, "v 2 2 0", "v 2 2", ":6: found 2 numbers, expected at least 3");
    expect("v 0 0 0\n", "v", "v", ": found no faces, expected an OBJ file with at least one");
}

TEST(Obj, ANulByteIsNoText) {
    const TemporaryFolder folder;
    for (const std::string start : {"", "\xEF\xBB\xBF"}) {
        const std::string text = start + kObj;
        const auto file = write_text(folder, "a.obj", text + std::string(3, '\0') + "\n" + kObj);
        EXPECT_EQ(message_of(read_obj, file),
                  file.string() + ": byte offset " + std::to_string(text.size()) +
                      ": found a NUL byte, expected the text of an OBJ file");
    }
}

TEST(MeshFiles, NumbersTooCloseToZeroAreZero) {
    const TemporaryFolder folder;
    std::string obj = kObj, ply = kAsciiPly;
    obj.replace(obj.find("vt 1 0.25"), 9, "vt -1e-999 0.25");
    EXPECT_EQ(read_obj(write_text(folder, "a.obj", obj)).uvs[1].x, 0);
    ply.replace(ply.find("1 0 0 0 0 1"), 1, "1e-999");
    EXPECT_EQ(read_ply(write_text(folder, "a.ply", ply)).positions[1].x, 0);
}

TEST(MeshFiles, DamagedFilesLoadOrThrow) {
    const TemporaryFolder folder;
    for (const std::string& text : {binary_ply(false), binary_ply(true), kAsciiPly, kObj}) {
        const bool is_obj = text == kObj;
        const auto read = [&](const std::filesystem::path& f) {
            return is_obj ? read_obj(f) : read_ply(f);
        };
        int refused = 0;
        for (std::uint32_t trial = 0; trial < 400; ++trial) {
            const auto random =
                philox4x32({trial, 0, 0, 0}, {13, static_cast<std::uint32_t>(Stream::kTest)});
            std::string bytes = text;
            bytes[random[0] % text.size()] = static_cast<char>(random[1]);
            if (trial % 4 == 0) bytes.resize(random[2] % text.size());
            refused += !message_of(read, write_text(folder, "mesh", bytes)).empty();
        }
        EXPECT_GT(refused, 40);
    }
}

Vec3f face_normal(const Mesh& mesh, std::size_t triangle = 0) {
    const auto corner = [&](std::size_t i) {
        return mesh.positions[mesh.triangles[triangle].vertex[i]];
    };
    return normalize(cross(corner(1) - corner(0), corner(2) - corner(0)));
}

Mesh one_triangle(bool with_normals) {
    Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {}, {{{0, 1, 2}}}};
    if (with_normals) mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    return mesh;
}

TEST(MeshShapes, ThatEmitHaveAnArea) {
    const TemporaryFolder folder;
    const std::string corners = "v 0 0 2\nv 1 0 2\nv 2 0 2\nv 0 1 2\n";
    const auto error = [&](const std::string& shape, const std::string& emitter) {
        return error_of(write_text(
            folder, "scene.xml",
            "<scene version='3.0.0'>\n  <shape " + shape + emitter + "</shape></scene>"));
    };
    const std::string obj = "type='obj'><string name='filename' value='a.obj'/>",
                      area = "<emitter type='area'/>",
                      none = "scene.xml:2:3: the shape emits and has no area, expected one that";
    for (const char* faces : {"f 1 2 3\n", "f 1 1 1\nf 1 2 3\n"}) {
        write_text(folder, "a.obj", corners + faces);
        EXPECT_NE(error(obj, area).find(none), std::string::npos) << error(obj, area);
        EXPECT_EQ(error(obj, ""), "");
    }
    write_text(folder, "a.obj", corners + "f 1 2 3\nf 1 2 4\n");
    EXPECT_EQ(error(obj, area), "");
    const std::string tiny = "type='sphere'><float name='radius' value='1e-23'/>";
    EXPECT_NE(error(tiny, area).find(none), std::string::npos) << "none in single precision";
    EXPECT_EQ(error(tiny, ""), "");
    const auto rectangle = [](const std::string& scale) {
        return "type='rectangle'><transform name='to_world'><scale value='" + scale +
               "'/></transform>";
    };
    EXPECT_NE(error(rectangle("1e-10"), area).find(none), std::string::npos);
    EXPECT_EQ(error(rectangle("1e-10"), ""), "");
    EXPECT_EQ(error(rectangle("1e-8"), area), "");
}

TEST(MeshNormals, MirrorsAndFlips) {
    const Transform mirror = scaling({-1, 1, 1});
    // The file's normals decide: both stay +z. Without them, the winding decides, and it turns.
    EXPECT_EQ(face_normal(finish_mesh(one_triangle(true), {mirror})).z, 1);
    EXPECT_EQ(finish_mesh(one_triangle(true), {mirror}).normals[0].z, 1);
    EXPECT_EQ(face_normal(finish_mesh(one_triangle(false), {mirror})).z, -1);
    EXPECT_EQ(finish_mesh(one_triangle(false), {mirror}).normals[0].z, -1);
    EXPECT_EQ(face_normal(finish_mesh(one_triangle(true), {mirror, true})).z, -1);
    EXPECT_TRUE(finish_mesh(one_triangle(true), {mirror, true}).normals.empty());
    for (const bool with_normals : {false, true}) {
        const Mesh flipped = finish_mesh(one_triangle(with_normals), {{}, false, true});
        EXPECT_EQ(face_normal(flipped).z, -1);
        EXPECT_EQ(flipped.normals[0].z, -1);
    }
    EXPECT_THROW(finish_mesh(one_triangle(false), {scaling({0, 1, 1})}), std::domain_error);
}

TEST(MeshFiles, WithoutTextureCoordinatesKeepTheirBarycentricOnes) {
    // As in Mitsuba, whose tangents they give, whichever way the faces look.
    Mesh plain = finish_mesh(one_triangle(true), {});
    Mesh flipped = finish_mesh(one_triangle(true), {{}, false, true});
    plain.uvs.clear(), flipped.uvs.clear();
    const auto uvs = corner_uvs(plain, plain.triangles[0]),
               turned = corner_uvs(flipped, flipped.triangles[0]);
    ASSERT_EQ(plain.triangles[0].vertex[1], flipped.triangles[0].vertex[2]);
    EXPECT_EQ(uvs[0], turned[0]);
    EXPECT_EQ(uvs[1], turned[2]);
    EXPECT_EQ(uvs[2], turned[1]);
    const Vec3f edge = plain.positions[plain.triangles[0].vertex[1]] -
                       plain.positions[plain.triangles[0].vertex[0]];
    EXPECT_EQ(tangents_of(plain, 0).dp_du, edge);
    EXPECT_EQ(tangents_of(flipped, 0).dp_du, edge);
}

TEST(MeshNormals, AreWeightedByAngle) {
    // A cube corner: one face is split in two triangles, so that it would count twice if weighted
    // by triangle.
    const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}},
                    {},
                    {},
                    {{{0, 1, 4}}, {{0, 4, 2}}, {{0, 2, 3}}, {{0, 3, 1}}}};
    const Vec3f n = finish_mesh(mesh, {}).normals[0];
    EXPECT_NEAR(n.x, n.z, 1e-6f);
    EXPECT_NEAR(n.y, n.z, 1e-6f);
}

TEST(MeshShapes, CubeAndRectangleFaceOutwards) {
    const Mesh cube = unit_cube();
    ASSERT_EQ(cube.triangles.size(), 12u);
    for (std::size_t i = 0; i < 12; ++i) {
        const Vec3f n = face_normal(cube, i), p = cube.positions[cube.triangles[i].vertex[0]];
        EXPECT_NEAR(dot(n, p), 1, 1e-6f);
        EXPECT_EQ(n, cube.normals[cube.triangles[i].vertex[0]]);
    }
    const Mesh rectangle = unit_rectangle();
    EXPECT_EQ(face_normal(rectangle), (Vec3f{0, 0, 1}));
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_EQ(rectangle.uvs[i].x, (rectangle.positions[i].x + 1) / 2);
}

}  // namespace
}  // namespace burnish
