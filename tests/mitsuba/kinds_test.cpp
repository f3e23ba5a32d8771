// Lights, shapes, attributes and cameras as the scene language gives them.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <tuple>

#include "burnish/image.h"
#include "error_of.h"
#include "mitsuba/ply.h"
#include "mitsuba/serialized.h"
#include "mitsuba/temporary_scene.h"
#include "paths/one_ray.h"
#include "render/renderer.h"
#include "scene/constants.h"

namespace burnish {
namespace {

const std::string kRest = "<sensor type='perspective'/><integrator type='direct'/>";
const std::string kSky = "<emitter type='constant'/>";

LoadedScene load_quietly(const TemporaryFolder& folder, const std::string& text) {
    LoadedScene loaded = load_text(folder, kRest + text);
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings[0];
    return loaded;
}

/// What is said of an unknown that the scene cannot have; empty: it can.
std::string refusal_of(Scene& scene, const std::string& parameter) {
    return test::error_of([&] { require_parameter(scene, parameter); });
}

TEST(Kinds, BeamsAndDirections) {
    const TemporaryFolder folder;
    const Scene scene =
        load_quietly(folder,
                     "<emitter type='spot' id='s'><rgb name='intensity' value='1 2 3'/><transform "
                     "name='to_world'><scale value='3'/><translate x='4'/></transform><texture "
                     "type='checkerboard' name='texture'/></emitter>"
                     "<emitter type='directional'><vector name='direction' x='0' y='-2' "
                     "z='0'/><float name='irradiance' value='4'/></emitter>"
                     "<emitter type='directional'><transform name='to_world'><scale z='3'/><rotate "
                     "y='1' angle='90'/></transform></emitter>"
                     "<emitter type='projector'><float name='scale' value='2'/><rgb "
                     "name='irradiance' value='1 2 3'/><float name='fov' value='30'/></emitter>")
            .scene;
    const auto& spot = std::get<SpotEmitter>(scene.emitters[0]);
    EXPECT_EQ(spot.cutoff, 20);
    EXPECT_EQ(spot.beam_width, 15);
    EXPECT_EQ(spot.intensity.z, 3);
    EXPECT_EQ(spot.to_world(0, 3), 4);
    EXPECT_NEAR(spot.to_world(0, 0), 1, 1e-12);
    EXPECT_TRUE(bool(spot.texture));
    EXPECT_EQ(scene.emitter_ids[0], "s");
    EXPECT_EQ(std::get<DirectionalEmitter>(scene.emitters[1]).direction, (Vec3f{0, -1, 0}));
    EXPECT_EQ(std::get<DirectionalEmitter>(scene.emitters[1]).irradiance.x, 4);
    EXPECT_NEAR(std::get<DirectionalEmitter>(scene.emitters[2]).direction.x, 1, 1e-6f);
    EXPECT_NEAR(std::get<DirectionalEmitter>(scene.emitters[2]).irradiance.x, 3, 1e-6f);
    const auto& projector = std::get<ProjectorEmitter>(scene.emitters[3]);
    EXPECT_EQ(projector.irradiance.z, 6);
    EXPECT_EQ(projector.fov_x, 30);
}

/// As in Mitsuba.
TEST(Kinds, TheScaleOfAProjectorMultipliesItsIrradiance) {
    const TemporaryFolder folder;
    for (const auto& [scale, factor] : {std::pair{"1", 1.0f}, {"3", 3.0f}, {"-0.5", 0.5f}}) {
        const Scene scene =
            load_quietly(folder,
                         "<emitter type='projector'><rgb name='irradiance' value='1 2 4'/><float "
                         "name='scale' value='2'/><transform name='to_world'><scale value='" +
                             std::string(scale) +
                             "'/><rotate y='1' angle='90'/><translate x='4'/></transform>"
                             "</emitter>")
                .scene;
        const auto& projector = std::get<ProjectorEmitter>(scene.emitters[0]);
        EXPECT_NEAR(projector.irradiance.x, 2 * factor, 1e-5f) << scale;
        EXPECT_NEAR(projector.irradiance.z, 8 * factor, 1e-5f) << scale;
        EXPECT_NEAR(std::abs(projector.to_world(0, 2)), 1, 1e-12) << scale;
        EXPECT_NEAR(projector.to_world(0, 3), 4, 1e-12) << scale;
    }
}

TEST(Kinds, ABeamWiderThanItsCutoffFillsTheCone) {
    const TemporaryFolder folder;
    const Scene scene =
        load_quietly(folder, "<emitter type='spot'><float name='beam_width' value='30'/></emitter>")
            .scene;
    const auto& spot = std::get<SpotEmitter>(scene.emitters[0]);
    EXPECT_EQ(spot.cutoff, 20);
    EXPECT_EQ(spot.beam_width, 20);
}

/// As in Mitsuba, which repeats the last row.
TEST(Kinds, AnEnvironmentOfTwoRowsHasThree) {
    const TemporaryFolder folder;
    Image rows = make_image(4, 2, 3);
    for (std::size_t i = 0; i < rows.values.size(); ++i) rows.values[i] = static_cast<float>(i);
    write_image(folder.path / "sky.exr", rows);
    const Scene scene = load_text(folder,
                                  "<emitter type='envmap'><string name='filename' "
                                  "value='sky.exr'/></emitter>")
                            .scene;
    const Image& sky = *std::get<EnvironmentEmitter>(scene.emitters[0]).image;
    ASSERT_TRUE(sky.width == 4 && sky.height == 3);
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 4; ++x)
            for (int c = 0; c < 3; ++c)
                EXPECT_EQ(sky.at(x, y, c), rows.at(x, std::min(y, 1), c)) << y;
}

TEST(Kinds, AnEnvironmentOfCodesIsDecoded) {
    const TemporaryFolder folder;
    for (const char* name : {"sky.png", "sky.exr"}) {
        write_image(folder.path / name, make_image(4, 3, 3, 0.5f));
        const Scene scene =
            load_text(folder, "<emitter type='envmap'><string name='filename' value='" +
                                  std::string(name) + "'/></emitter>")
                .scene;
        EXPECT_NEAR(std::get<EnvironmentEmitter>(scene.emitters[0]).image->values[5], 0.5f, 0.005f)
            << name;
    }
}

TEST(Kinds, TexturesOfLightsAreNoUnknownsAndMayBeBright) {
    const TemporaryFolder folder;
    write_image(folder.path / "bright.exr", make_image(4, 2, 3, 7.0f));
    const std::string texture =
        "<texture type='bitmap' name='NAME'><string name='filename' value='bright.exr'/></texture>";
    const auto named = [&](const char* name) {
        std::string text = texture;
        return text.replace(text.find("NAME"), 4, name);
    };
    const Scene scene =
        load_quietly(folder, "<shape type='rectangle'><emitter type='area'>" + named("radiance") +
                                 "</emitter></shape><emitter type='projector'>" +
                                 named("irradiance") + "</emitter>")
            .scene;
    EXPECT_TRUE(scene.parameters.empty());
    const auto& area = std::get<AreaEmitter>(scene.emitters[0]);
    EXPECT_TRUE(bool(area.texture));
    EXPECT_NEAR(mean_radiance(scene, area).y, area.radiance.y * 7, 1e-5f);
    EXPECT_EQ(std::get<ProjectorEmitter>(scene.emitters[1]).aspect, 2);
    EXPECT_NEAR(mean_magnitude(scene.textures[0]).y, 7, 1e-5f);
}

/// Where Mitsuba 3.9.1 has the texture coordinates of a tilted cylinder.
TEST(Kinds, CylindersHaveMitsubasCoordinates) {
    const TemporaryFolder folder;
    const Scene scene =
        load_quietly(folder, kSky +
                                 "<shape type='cylinder'><point name='p0' x='0.1' y='-0.2' "
                                 "z='0.3'/><point name='p1' x='0.5' y='0.7' z='-0.6'/><float "
                                 "name='radius' value='0.3'/></shape>")
            .scene;
    const TracedScene traced = prepare(scene);
    struct Row {
        Vec3f p, n;
        Vec2f uv;
        Vec3f s;
    };
    const Row rows[] = {{{0.5196979f, 0.8418433f, -0.32292205f},
                         {0.1509269f, 0.6646624f, 0.731741f},
                         {0.7954883f, 0.9360494f},
                         {0.9419837f, -0.32119724f, 0.09746216f}},
                        {{0.01826399f, 0.1280562f, -0.23655638f},
                         {-0.8308481f, -0.16286737f, -0.53213316f},
                         {0.4384385f, 0.418796f},
                         {-0.46883243f, 0.72001255f, 0.5116425f}}};
    for (const Row& row : rows) {
        const Vec3f origin = row.p + row.n * 0.5f, direction = -row.n;
        const Hit hit = first_hit(traced.geometry->accel, origin, direction);
        ASSERT_EQ(hit.shape, 0);
        EXPECT_NEAR(hit.distance, 0.5f, 1e-5f);
        const Surface s = surface_at(scene, traced.geometry->triangles, hit, origin, direction);
        EXPECT_NEAR(length(s.geometric_normal - row.n), 0, 1e-5f);
        EXPECT_NEAR(length(s.shading.s - row.s), 0, 1e-5f);
        EXPECT_NEAR(s.uv.x, row.uv.x, 1e-5f);
        EXPECT_NEAR(s.uv.y, row.uv.y, 1e-5f);
    }
}

TEST(Kinds, AnAxisThatIsNoUnitScalesAsInMitsuba) {
    const TemporaryFolder folder;
    const auto cube = [&](const char* axis) {
        const Scene scene =
            load_quietly(folder, kSky + "<shape type='cube'><transform name='to_world'><rotate " +
                                     axis + " angle='35'/></transform></shape>")
                .scene;
        return std::get<Mesh>(scene.shapes[0].geometry);
    };
    EXPECT_TRUE(cube("x='1'").normals.empty());
    const Mesh skewed = cube("x='1' y='1'");
    double longest = 0;
    for (const Vec3f& p : skewed.positions) longest = std::max(longest, double{p.y});
    EXPECT_NEAR(longest, 1 + 0.18084796 + 0.57357646, 1e-6);
    bool found = false;  // moved by the matrix itself, not by its inverse
    for (const Vec3f& n : skewed.normals)
        found |= length(n - Vec3f{0.85695875f, 0.15497924f, -0.49153134f}) < 1e-5f;
    EXPECT_TRUE(found);
}

TEST(Kinds, InstancesShareTheirPrototypes) {
    const TemporaryFolder folder;
    const Scene scene =
        load_quietly(
            folder,
            kSky +
                "<shape type='instance' id='early'><ref id='g'/><transform name='to_world'>"
                "<translate x='3'/></transform></shape>"
                "<shape type='shapegroup' id='g'><shape type='cube' id='c'/><shape "
                "type='sphere' id='s'><point name='center' y='5'/></shape></shape>"
                "<shape type='instance'><ref id='g'/><transform name='to_world'><scale x='-2' "
                "y='1' z='1'/><translate z='9'/></transform></shape>"
                "<shape type='merge'><shape type='disk'/><shape type='rectangle'/></shape>")
            .scene;
    EXPECT_EQ(scene.prototypes.size(), 2u);
    ASSERT_EQ(scene.shapes.size(), 6u);
    EXPECT_EQ(scene.shapes[0].id, "early.c");
    EXPECT_TRUE(std::holds_alternative<Disk>(scene.shapes[4].geometry));
    const TracedScene traced = prepare(scene);
    const auto look = [&](const Vec3f& origin, const Vec3f& direction) {
        const Hit hit = first_hit(traced.geometry->accel, origin, direction);
        return std::pair{hit.shape, hit.shape < 0 ? Surface{}
                                                  : surface_at(scene, traced.geometry->triangles,
                                                               hit, origin, direction)};
    };
    const auto [cube, face] = look({3.2f, 0.1f, -4}, {0, 0, 1});
    EXPECT_EQ(cube, 0);
    EXPECT_NEAR(length(face.position - Vec3f{3.2f, 0.1f, -1}), 0, 1e-6f);
    EXPECT_NEAR(face.geometric_normal.z, -1, 1e-6f);
    const auto [sphere, top] = look({3, 9, 0}, {0, -1, 0});
    EXPECT_EQ(sphere, 1);
    EXPECT_NEAR(length(top.position - Vec3f{3, 6, 0}), 0, 1e-5f);
    EXPECT_NEAR(top.geometric_normal.y, 1, 1e-6f);
    const auto [mirrored, side] = look({-5, 0.3f, 9.2f}, {1, 0, 0});
    EXPECT_EQ(mirrored, 2);
    EXPECT_NEAR(side.position.x, -2, 1e-6f);
    EXPECT_NEAR(side.geometric_normal.x, -1, 1e-6f);
    EXPECT_NEAR(box_of(scene, scene.shapes[2]).high.z, 10, 1e-5f);
}

const char* const kPly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\nproperty float r\nproperty float g\nproperty float b\nproperty float heat_x\nelement face "
    "1\nproperty list uchar int vertex_indices\nproperty float face_0\nproperty float "
    "red\nproperty float green\nproperty float blue\nend_header\n"
    "-1 -1 0 0.1 0.2 0.3 0.5\n1 -1 0 0.9 0.4 0.1 0.25\n1 1 0 0.2 0.8 0.6 0\n-1 1 0 0.3 0.5 0.7 1\n"
    "4 0 1 2 3 0.75 0.125 0.25 0.375\n";

TEST(Kinds, AttributesOfVerticesAndFaces) {
    const TemporaryFolder folder;
    const mitsuba::MeshFile file = mitsuba::read_ply_file(write_text(folder, "a.ply", kPly));
    ASSERT_EQ(file.attributes.size(), 4u);
    EXPECT_EQ(file.attributes[0].name, "vertex_color");
    EXPECT_EQ(file.attributes[1].name, "vertex_heat");
    EXPECT_EQ(file.attributes[1].channels, 1);
    EXPECT_EQ(file.attributes[2].name, "face_face");
    EXPECT_EQ(file.attributes[3].name, "face_color");
    EXPECT_EQ(file.attributes[3].values,
              (std::vector<float>{0.125f, 0.25f, 0.375f, 0.125f, 0.25f, 0.375f}));
}

/// Attributes are named as Mitsuba names them; what is neither one value nor three is passed over.
TEST(Kinds, AttributesHaveMitsubasNames) {
    const TemporaryFolder folder;
    const auto names = [&](const std::vector<std::string>& properties) {
        std::string header =
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\n";
        std::string values;
        for (const std::string& p : properties)
            header += "property float " + p + "\n", values += " 1";
        std::string rows;
        for (const char* position : {"0 0 0", "1 0 0", "0 1 0"}) rows += position + values + "\n";
        const mitsuba::MeshFile file = mitsuba::read_ply_file(write_text(
            folder, "b.ply",
            header + "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + rows +
                "3 0 1 2\n"));
        std::vector<std::string> found;
        for (const mitsuba::MeshAttribute& a : file.attributes) found.push_back(a.name);
        return found;
    };
    using Names = std::vector<std::string>;
    EXPECT_EQ(names({"tint_r", "tint_g", "tint_b"}), Names{"vertex_tint_color"});
    EXPECT_EQ(names({"rough_r"}), Names{"vertex_rough_color"});
    EXPECT_EQ(names({"a_b_x", "a_b_y", "a_b_z"}), Names{"vertex_a_b"});
    EXPECT_EQ(names({"t_1", "t_2", "t_3", "u_0"}), (Names{"vertex_t", "vertex_u"}));
    EXPECT_EQ(names({"r", "g", "b", "a"}), Names{"vertex_color"});
    EXPECT_EQ(names({"red", "green", "blue", "alpha"}), Names{"vertex_color"});
    names({"tint_r", "tint_g", "tint_b"});  // writes b.ply
    for (const char* name : {"vertex_tint_color", "vertex_tint"}) {
        const std::string texture =
            "<shape type='ply'><string name='filename' value='b.ply'/><bsdf type='diffuse'>"
            "<texture type='mesh_attribute' name='reflectance'><string name='name' value='" +
            std::string(name) + "'/></texture></bsdf></shape>";
        EXPECT_NO_THROW(load_quietly(folder, kSky + texture)) << name;
    }
    EXPECT_EQ(names({"uv_x", "uv_y", "heat_x"}), Names{"vertex_heat"});
    EXPECT_EQ(names({"tint_r", "tint_g", "tint_b", "tint_a", "n_x"}), Names{"vertex_n"});
}

/// What the middle and a corner of the square show is interpolated within its triangles.
TEST(Kinds, MeshAttributesAreInterpolatedInTheirTriangles) {
    const TemporaryFolder folder;
    write_text(folder, "a.ply", kPly);
    const Scene scene =
        load_quietly(folder, kSky +
                                 "<shape type='ply'><string name='filename' value='a.ply'/><bsdf "
                                 "type='principled' id='m'><texture type='mesh_attribute' "
                                 "name='base_color'><string name='name' value='vertex_color'/>"
                                 "<float name='scale' value='0.5'/></texture><texture "
                                 "type='mesh_attribute' name='roughness'><string name='name' "
                                 "value='vertex_heat'/></texture></bsdf></shape>")
            .scene;
    EXPECT_TRUE(scene.parameters.empty());
    const TracedScene traced = prepare(scene);
    const auto& bsdf = std::get<Principled>(scene.bsdfs[0]);
    const TextureTable table{scene.textures, {}};
    const auto read = [&](float x, float y) {
        const Vec3f origin{x, y, 2}, direction{0, 0, -1};
        const Hit hit = first_hit(traced.geometry->accel, origin, direction);
        const Surface s = surface_at(scene, traced.geometry->triangles, hit, origin, direction);
        return std::pair{eval_color(table, bsdf.base_color, s.uv),
                         eval_scalar(table, bsdf[PrincipledScalar::kRoughness], s.uv)};
    };
    // Triangle 0 1 2, weights 0.25, 0.5, 0.25
    const auto [color, heat] = read(0.5f, -0.5f);
    EXPECT_NEAR(color.x, 0.5f * (0.25f * 0.1f + 0.5f * 0.9f + 0.25f * 0.2f), 1e-4f);
    EXPECT_NEAR(color.z, 0.5f * (0.25f * 0.3f + 0.5f * 0.1f + 0.25f * 0.6f), 1e-4f);
    EXPECT_NEAR(heat, 0.25f * 0.5f + 0.5f * 0.25f, 1e-4f);
    EXPECT_NEAR(read(-0.999f, 0.999f).second, 1, 2e-3f);
}

TEST(Kinds, TexturesThatNoImageHoldsAreRefused) {
    const TemporaryFolder folder;
    Scene scene = load_quietly(folder, kSky +
                                           "<bsdf type='diffuse' id='m'/><shape type='rectangle'>"
                                           "<ref id='m'/></shape>")
                      .scene;
    EXPECT_EQ(refusal_of(scene, "m.reflectance:16384"),
              "m.reflectance: found 16384 x 16384 texels of 3 channels, expected at most 536870912 "
              "values");
}

TEST(Kinds, MeshAttributesCannotBeRecovered) {
    const TemporaryFolder folder;
    write_text(folder, "a.ply", kPly);
    Scene scene =
        load_quietly(folder, kSky +
                                 "<bsdf type='diffuse' id='m'><texture type='mesh_attribute' "
                                 "name='reflectance'><string name='name' value='face_color'/>"
                                 "</texture></bsdf><shape type='ply'><string name='filename' "
                                 "value='a.ply'/><ref id='m'/></shape>")
            .scene;
    const std::string error = refusal_of(scene, "m.reflectance");
    EXPECT_NE(error.find("reads a mesh attribute, which cannot"), std::string::npos) << error;
}

// ---- serialized

template <class T>
void put(std::string& bytes, T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// A triangle with normals and coordinates, in floats or doubles.
std::string mesh_stream(bool doubles, std::uint32_t last_index = 2, std::uint64_t vertices = 3,
                        std::uint32_t more_flags = 0) {
    std::string raw;
    put(raw, std::uint32_t{3} | (doubles ? 0x2000u : 0x1000u) | more_flags);
    raw.append("name\0", 5);
    put(raw, vertices);
    put(raw, std::uint64_t{1});
    for (int i = 0; i < 3 * 8; ++i)
        if (doubles)
            put(raw, 0.25 * i);
        else
            put(raw, 0.25f * static_cast<float>(i));
    for (const std::uint32_t i : {0u, 1u, last_index}) put(raw, i);
    std::string packed(compressBound(raw.size()), '\0');
    uLongf size = packed.size();
    compress(reinterpret_cast<Bytef*>(packed.data()), &size,
             reinterpret_cast<const Bytef*>(raw.data()), raw.size());
    packed.resize(size);
    return packed;
}

std::string serialized(const std::vector<std::string>& streams) {
    std::string bytes;
    std::vector<std::uint64_t> begin;
    for (const std::string& stream : streams) {
        begin.push_back(bytes.size());
        put(bytes, std::uint16_t{0x041C}), put(bytes, std::uint16_t{4});
        bytes += stream;
    }
    for (const std::uint64_t b : begin) put(bytes, b);
    put(bytes, static_cast<std::uint32_t>(streams.size()));
    return bytes;
}

TEST(Kinds, SerializedMeshes) {
    const TemporaryFolder folder;
    constexpr std::uint32_t kFaceNormals = 0x10;  // without effect, as in Mitsuba
    write_text(folder, "a.serialized",
               serialized({mesh_stream(false), mesh_stream(true),
                           mesh_stream(false, 2, 3, kFaceNormals)}));
    for (const char* index : {"0", "1", "2"}) {
        const Scene scene =
            load_quietly(folder, kSky +
                                     "<shape type='serialized'><string name='filename' "
                                     "value='a.serialized'/><integer name='shape_index' value='" +
                                     index + "'/></shape>")
                .scene;
        const auto& mesh = std::get<Mesh>(scene.shapes[0].geometry);
        EXPECT_EQ(mesh.positions[1], (Vec3f{0.75f, 1, 1.25f}));
        EXPECT_EQ(mesh.uvs[0].x, 0.25f * 18);
        EXPECT_EQ(mesh.triangles[0].vertex[2], 2u);
        EXPECT_EQ(mesh.normals.size(), 3u);
    }
}

std::string serialized_error(const TemporaryFolder& folder, const std::string& bytes,
                             std::size_t index = 0) {
    return test::error_of(
        [&] { mitsuba::read_serialized(write_text(folder, "b.serialized", bytes), index); });
}

TEST(Kinds, DamagedSerializedMeshesGiveASentence) {
    const TemporaryFolder folder;
    const auto expect = [&](const std::string& bytes, const char* text, std::size_t index = 0) {
        const std::string error = serialized_error(folder, bytes, index);
        EXPECT_NE(error.find(text), std::string::npos) << error << "\nexpected " << text;
    };
    const std::string good = serialized({mesh_stream(false)});
    EXPECT_EQ(serialized_error(folder, good), "");
    expect(good, "there is no mesh 1, expected one from 0 to 0", 1);
    expect("", "the file ends too early");
    expect("plyply", "found the signature");
    expect(serialized({mesh_stream(false, 3)}), "found the vertex index 3, expected one in [0, 2]");
    expect(serialized({mesh_stream(false, 2, 1u << 30)}), "which its stream cannot hold");
    expect(serialized({mesh_stream(false, 2, 100)}), "ends too early or cannot be decompressed");
    expect(serialized({mesh_stream(false).substr(0, 20)}), "ends too early");
    std::string list = good;
    list[list.size() - 3] = 1;  // 257 meshes
    expect(list, "its list of meshes is longer than the file");
    for (std::size_t i = 0; i < good.size(); ++i) {
        std::string damaged = good;
        damaged[i] = static_cast<char>(damaged[i] ^ 0x55);
        serialized_error(folder, damaged);  // or it is read, with other numbers
        serialized_error(folder, good.substr(0, i));
    }
}

// ---- cameras and films

TEST(Kinds, HiddenEmittersAreSeenThrough) {
    const TemporaryFolder folder;
    const auto seen = [&](const char* hide) {
        const Scene scene =
            load_text(folder, std::string("<integrator type='direct'><boolean name='hide_emitters' "
                                          "value='") +
                                  hide +
                                  "'/></integrator><sensor type='perspective'/><shape "
                                  "type='rectangle'><transform name='to_world'><translate "
                                  "z='3'/></transform><emitter type='area'/></shape><shape "
                                  "type='sphere'><point name='center' z='6'/></shape>")
                .scene;
        const TracedScene traced = prepare(scene);
        const Vec3f origin{0, 0, 0}, forward{0, 0, 1};
        EXPECT_EQ(first_hit(traced.geometry->accel, origin, forward).shape, 0);
        return first_hit(camera_accel(*traced.geometry), origin, forward).shape;
    };
    EXPECT_EQ(seen("false"), 0);
    EXPECT_EQ(seen("true"), 1);
}

TEST(Kinds, CamerasAndPixelFormats) {
    const TemporaryFolder folder;
    const auto sensor = [&](const std::string& text) {
        return load_text(folder, "<integrator type='direct'/>" + kSky + text).scene;
    };
    const Scene parallel = sensor(
        "<sensor type='orthographic'><float name='near_clip' value='1'/><float name='far_clip' "
        "value='20'/><transform name='to_world'><scale x='3' y='3' "
        "z='2'/><translate x='1'/></transform><film type='hdrfilm'><string "
        "name='pixel_format' value='RGBA'/></film></sensor>");
    EXPECT_NEAR(parallel.camera.orthographic_width, 6, 1e-12);
    EXPECT_NEAR(parallel.camera.to_world(2, 2), 1, 1e-12);
    EXPECT_EQ(parallel.camera.near_clip, 2);
    EXPECT_EQ(parallel.camera.far_clip, 21);
    EXPECT_EQ(parallel.film.pixel_format, PixelFormat::kRgba);
    const Scene lens = sensor(
        "<sensor type='thinlens'><float name='aperture_radius' value='0.5'/><float "
        "name='far_clip' value='70'/><film type='hdrfilm'><string name='pixel_format' "
        "value='luminance'/><string name='component_format' "
        "value='float32'/></film></sensor>");
    EXPECT_EQ(lens.camera.aperture_radius, 0.5f);
    EXPECT_EQ(lens.camera.focus_distance, 70);
    EXPECT_EQ(lens.film.pixel_format, PixelFormat::kLuminance);
    const Scene widest = sensor(
        "<sensor type='perspective'><float name='fov' value='179.9999999999'/><float "
        "name='far_clip' value='3e38'/></sensor>");
    EXPECT_GT(widest.camera.fov_x, 179.9999);
    const Scene endless = sensor(
        "<sensor type='thinlens'><float name='aperture_radius' value='1'/><float name='far_clip' "
        "value='3e38'/></sensor>");
    EXPECT_EQ(endless.camera.focus_distance, 1e12f);
    const std::string aperture = "<float name='aperture_radius' value='1'/>";
    for (const std::string& type : {"thinlens'>" + aperture, std::string("orthographic'>")}) {
        const LoadedScene moved =
            load_text(folder, "<integrator type='direct'/>" + kSky + "<sensor type='" + type +
                                  "<float name='principal_point_offset_x' value='0.25'/></sensor>");
        EXPECT_EQ(moved.scene.camera.principal_offset_x, 0);
        ASSERT_EQ(moved.warnings.size(), 1u) << type;
        EXPECT_NE(moved.warnings[0].find("does not know \"principal_point_offset_x\""),
                  std::string::npos)
            << moved.warnings[0];
    }
}

TEST(Kinds, SamplesAreThoseOfTheFirstSensor) {
    const TemporaryFolder folder;
    const auto sensor = [](const std::string& count) {
        return "<sensor type='perspective'><sampler type='independent'><integer "
               "name='sample_count' value='" +
               count + "'/></sampler></sensor>";
    };
    const Scene scene =
        load_text(folder, "<integrator type='direct'/>" + kSky + sensor("8") + sensor("32")).scene;
    ASSERT_EQ(scene.sensors.size(), 2u);
    EXPECT_EQ(scene.sample_count, 8);
}

TEST(Kinds, NumbersOfSensorsCountThoseThatAreLeftOut) {
    const TemporaryFolder folder;
    const auto sensor = [](const std::string& type, int width) {
        return "<sensor type='" + type + "'><film type='hdrfilm'><integer name='width' value='" +
               std::to_string(width) + "'/></film></sensor>";
    };
    const Renderer renderer = make_renderer(
        load_text(folder, "<integrator type='direct'/>" + kSky + sensor("perspective", 8) +
                              sensor("batch", 9) + sensor("perspective", 10)));
    EXPECT_EQ(renderer.with_camera(Sensor{"0"}).width(), 8);
    EXPECT_EQ(renderer.with_camera(Sensor{"2"}).width(), 10);
    EXPECT_EQ(renderer.with_camera(Sensor{"sensor_2"}).width(), 10);
    EXPECT_THROW(renderer.with_camera(Sensor{"1"}), InputError);
}

TEST(Kinds, MadeUpIdsAreNoneThatTheSceneGives) {
    const TemporaryFolder folder;
    const Scene scene =
        load_text(folder,
                  "<sensor type='perspective'/><sensor type='perspective' id='sensor_0'/>"
                  "<emitter type='point'/><emitter type='point' id='emitter_0'/>"
                  "<bsdf type='diffuse'/><bsdf type='diffuse' id='bsdf_0'/>"
                  "<shape type='sphere'/><shape type='sphere' id='shape_0'/>"
                  "<shape type='sphere' id='shape_4'/>"
                  "<shape type='shapegroup' id='group'><shape type='sphere'/></shape>"
                  "<shape type='instance'><ref id='group'/></shape>")
            .scene;
    const auto ids_of = [](const auto& all) {
        std::vector<std::string> ids;
        for (const auto& one : all) ids.push_back(one.id);
        return ids;
    };
    using Ids = std::vector<std::string>;
    EXPECT_EQ(ids_of(scene.sensors), (Ids{"sensor_0_", "sensor_0"}));
    EXPECT_EQ(scene.emitter_ids, (Ids{"emitter_0_", "emitter_0"}));
    EXPECT_EQ(ids_of(scene.shapes), (Ids{"shape_0_", "shape_0", "shape_4", "shape_4_"}));
    const Ids materials = ids_of(scene.materials);
    ASSERT_GE(materials.size(), 2u);
    EXPECT_EQ(Ids(materials.begin(), materials.begin() + 2), (Ids{"bsdf_0_", "bsdf_0"}));
}

TEST(Kinds, PicturesThatNoFileHoldsAreRefusedWithoutAFilmToo) {
    const TemporaryFolder folder;
    LoadOptions large;
    large.width = large.height = 30000;
    for (const char* sensor : {"", "<sensor type='perspective'/>",
                               "<sensor type='perspective'><film type='hdrfilm'/></sensor>"}) {
        const auto file =
            write_text(folder, "large.xml", "<scene version='3.0.0'>" + kSky + sensor + "</scene>");
        EXPECT_THROW(load_scene(file, large), InputError) << sensor;
        EXPECT_NO_THROW(load_scene(file, {})) << sensor;
    }
}

// ---- what is told while a scene is read

/// A mesh of one triangle in each format, a texture and a sky.
std::string scene_of_files(const TemporaryFolder& folder) {
    const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    write_text(folder, "a.obj", points + "f 1 2 3\n");
    write_text(folder, "a.serialized", serialized({mesh_stream(false)}));
    write_text(folder, "a.ply",
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
               "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
               "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    write_image((folder.path / "a.png").string(), make_image(2, 2, 3, 0.5f));
    write_image((folder.path / "a.exr").string(), make_image(4, 3, 3, 0.5f));
    std::string text;
    for (const std::string type : {"obj", "ply", "serialized"})
        text +=
            "<shape type='" + type + "'><string name='filename' value='a." + type + "'/></shape>";
    return text +
           "<shape type='sphere'><bsdf type='diffuse'><texture type='bitmap' name='reflectance'>"
           "<string name='filename' value='a.png'/></texture></bsdf></shape>"
           "<emitter type='envmap'><string name='filename' value='a.exr'/></emitter>";
}

TEST(Kinds, WhatFilesTakeIsToldBeforeTheyAreRead) {
    const TemporaryFolder folder;
    using Told = std::tuple<std::string, double, double>;
    std::vector<Told> told, expected;
    LoadOptions options;
    options.before_reading = [&](const std::filesystem::path& file, double bytes, double before) {
        told.emplace_back(file.filename().string(), bytes, before);
    };
    const LoadedScene loaded = load_text(folder, scene_of_files(folder), options);
    double before = 0;
    const auto expect = [&](const std::string& name, double beside) {
        const auto size = static_cast<double>(std::filesystem::file_size(folder.path / name));
        expected.emplace_back(name, size + beside, before);
    };
    constexpr double kTriangle = 3 * sizeof(Vec3f) + sizeof(Triangle);
    const auto keep = [&](std::size_t shape) {
        before += static_cast<double>(bytes_of(*mesh_of(loaded.scene.shapes[shape].geometry)));
    };
    expect("a.obj", 0), keep(0);
    expect("a.ply", 0), expect("a.ply", kTriangle), keep(1);
    expect("a.serialized", 0), expect("a.serialized", kTriangle), keep(2);
    expect("a.png", 2 * 2 * 3 * sizeof(float)), before += 2 * 2 * 3;  // codes are kept
    expect("a.exr", (4 * 3 + 4 * 16) * 3 * sizeof(float));            // ZIP has 16 rows in a chunk
    EXPECT_EQ(told, expected);
}

TEST(Kinds, WhatMeshAttributesTakeIsToldBeforeTheyAreMade) {
    const TemporaryFolder folder;
    write_text(folder, "a.ply",
               "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
               "property float z\nproperty float r\nproperty float g\nproperty float b\n"
               "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
               "0 0 0 1 1 1\n1 0 0 1 1 1\n1 1 0 1 1 1\n0 1 0 1 1 1\n4 0 1 2 3\n");
    std::vector<std::pair<double, double>> told;
    LoadOptions options;
    options.before_reading = [&](const std::filesystem::path& file, double bytes, double before) {
        EXPECT_EQ(file, folder.path / "a.ply");
        told.emplace_back(bytes, before);
    };
    const std::string color =
        "<texture type='mesh_attribute' name='reflectance'><string name='name' "
        "value='vertex_color'/></texture>";
    const std::string shape =
        "<shape type='ply'><string name='filename' value='a.ply'/><bsdf type='blendbsdf'><float "
        "name='weight' value='0.5'/><bsdf type='diffuse'>" +
        color + "</bsdf><bsdf type='diffuse'>" + color + "</bsdf></bsdf></shape>";
    const LoadedScene loaded = load_text(folder, shape + shape, options);
    const Mesh& mesh = *mesh_of(loaded.scene.shapes.at(0).geometry);
    const double all = static_cast<double>(bytes_of(mesh)),
                 bitmap = 2 * 4 * 3 * sizeof(float),  // four texels for each of two triangles
        kept = all - static_cast<double>(mesh.lookup_uvs.size() * sizeof(Vec2f)),
                 beside = 2 * sizeof(Triangle) + 4 * 3 * sizeof(float);
    ASSERT_EQ(told.size(), 8u);
    using Told = std::pair<double, double>;
    EXPECT_EQ(told[2], Told(bitmap + beside, kept));
    EXPECT_EQ(told[3], Told(bitmap + beside, kept + bitmap));
    EXPECT_EQ(told[4].second, all + 2 * bitmap);
    EXPECT_EQ(told[7], Told(bitmap + beside, all + 2 * bitmap + kept + bitmap));
}

TEST(Kinds, WhatIsThrownBeforeAFileIsReadEndsTheReading) {
    const TemporaryFolder folder;
    const std::string text = scene_of_files(folder);
    for (const char* name : {"a.obj", "a.ply", "a.serialized", "a.png", "a.exr"}) {
        LoadOptions options;
        options.ignore_unsupported = true;
        options.before_reading = [&](const std::filesystem::path& file, double, double) {
            if (file.filename() == name) throw ResourceError(name);
        };
        EXPECT_EQ(test::error_of<ResourceError>([&] { load_text(folder, text, options); }), name);
    }
}

// ---- what is left out

TEST(Kinds, UnsupportedThingsCanBeLeftOut) {
    const TemporaryFolder folder;
    LoadOptions options;
    options.ignore_unsupported = true;
    const LoadedScene loaded = load_text(
        folder,
        kRest + kSky +
            "\n<shape type='bsplinecurve'/>\n<medium type='homogeneous' id='fog'/>\n<shape "
            "type='cube'><ref name='interior' id='fog'/><bsdf type='hair'/></shape>\n<emitter "
            "type='sunsky'/>\n<shape type='sphere'><emitter type='directionalarea'/></shape>",
        options);
    EXPECT_EQ(loaded.scene.shapes.size(), 2u);
    EXPECT_EQ(loaded.scene.emitters.size(), 1u);
    EXPECT_EQ(loaded.scene.emitter_ids.size(), 1u);
    ASSERT_EQ(loaded.warnings.size(), 6u);
    const char* const expected[] = {"shape \"bsplinecurve\"",
                                    "<medium> (participating media)",
                                    "the participating medium \"interior\"",
                                    "bsdf \"hair\"",
                                    "emitter \"sunsky\"",
                                    "emitter \"directionalarea\""};
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_NE(loaded.warnings[i].find(expected[i]), std::string::npos) << loaded.warnings[i];
        EXPECT_NE(loaded.warnings[i].find(": left out, "), std::string::npos) << loaded.warnings[i];
    }
}

TEST(Kinds, WhatSeveralShapesShowIsLeftOutWithOneWarning) {
    const TemporaryFolder folder;
    LoadOptions options;
    options.ignore_unsupported = true;
    std::string shapes;
    for (int i = 0; i < 20; ++i) shapes += "<shape type='sphere'><ref id='h'/></shape>";
    const LoadedScene loaded = load_text(
        folder, kRest + kSky + "<bsdf type='mask' id='h'><bsdf type='hair'/></bsdf>" + shapes,
        options);
    EXPECT_EQ(loaded.scene.shapes.size(), 20u);
    // Beside that of the element itself.
    EXPECT_EQ(std::ranges::count_if(
                  loaded.warnings,
                  [](const std::string& text) { return text.ends_with("its shape is diffuse"); }),
              1);
    EXPECT_EQ(loaded.warnings.size(), 2u);
}

TEST(Kinds, UnsupportedColoursCanBeLeftOut) {
    const TemporaryFolder folder;
    LoadOptions options;
    options.ignore_unsupported = true;
    const LoadedScene loaded = load_text(
        folder,
        kRest +
            "\n<emitter type='constant'><texture type='checkerboard' name='radiance'/></emitter>" +
            kSky +
            "\n<shape type='cube'><bsdf type='diffuse'><spectrum name='reflectance' "
            "type='blackbody'/></bsdf></shape>",
        options);
    EXPECT_EQ(loaded.scene.emitters.size(), 1u);
    EXPECT_EQ(loaded.scene.shapes.size(), 1u);
    ASSERT_EQ(loaded.warnings.size(), 2u);
    EXPECT_NE(loaded.warnings[0].find("\"radiance\" as a texture"), std::string::npos);
    EXPECT_NE(loaded.warnings[1].find("spectrum \"blackbody\""), std::string::npos);
}

TEST(Kinds, UnsupportedMembersAreLeftOutOneByOne) {
    const TemporaryFolder folder;
    LoadOptions options;
    options.ignore_unsupported = true;
    const auto load = [&](const std::string& text) {
        return load_text(folder, kRest + kSky + text, options);
    };
    const std::string members =
        "<shape type='cube'/><shape type='heightfield'/><shape type='sphere'/></shape>";
    const LoadedScene merged = load("<shape type='merge'>" + members);
    EXPECT_EQ(merged.scene.shapes.size(), 2u);
    EXPECT_EQ(merged.warnings.size(), 1u);
    const std::string place = "<shape type='instance'><ref id='g'/></shape>";
    const LoadedScene group = load("<shape type='shapegroup' id='g'>" + members + place + place);
    EXPECT_EQ(group.scene.prototypes.size(), 2u);
    EXPECT_EQ(group.scene.shapes.size(), 4u);
    EXPECT_EQ(group.warnings.size(), 1u);
    const LoadedScene none =
        load("<shape type='shapegroup' id='g'><shape type='heightfield'/></shape>" + place + place);
    EXPECT_TRUE(none.scene.shapes.empty());
    EXPECT_EQ(none.warnings.size(), 1u);
    const LoadedScene dark = load(
        "<shape type='shapegroup' id='g'><shape type='cube'><emitter "
        "type='area'/></shape></shape>" +
        place);
    EXPECT_EQ(dark.scene.shapes.size(), 1u);
    EXPECT_EQ(dark.warnings.size(), 1u);
}

}  // namespace
}  // namespace burnish
