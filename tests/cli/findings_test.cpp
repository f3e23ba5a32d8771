// What `burnish info` finds wrong, each on a small scene that has it, and on one that has not.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <ctime>
#include <functional>

#include "cli/console.h"
#include "cli/findings.h"
#include "cli/inspect.h"
#include "mitsuba/temporary_scene.h"

namespace burnish {
namespace {

const std::string kCamera =
    "<integrator type='direct'/><sensor type='perspective'><transform name='to_world'><lookat "
    "origin='0, 0, 5' target='0, 0, 0' up='0, 1, 0'/></transform><film type='hdrfilm'><integer "
    "name='width' value='32'/><integer name='height' value='32'/></film></sensor>";
const std::string kSky = "<emitter type='constant'/>";

std::vector<std::string> findings_of(const TemporaryFolder& folder, const std::string& text) {
    const LoadedScene loaded = load_text(folder, kCamera + text);
    return inspect(prepare(loaded.scene)).findings;
}

std::string textured(const TemporaryFolder& folder, int size) {
    write_image(folder.path / "t.exr", make_image(size, size, 3, 0.5f));
    return "<bsdf type='diffuse' id='m'><texture type='bitmap' name='reflectance'><string "
           "name='filename' value='t.exr'/></texture></bsdf>";
}

/// Two triangles with the given texture coordinates of the second.
std::string two_triangles(const TemporaryFolder& folder, const std::string& second) {
    write_text(folder, "a.obj",
               "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 0.4 0\nvt 0.4 0.4\n" + second +
                   "f 1/1 2/2 3/3\nf 1/4 3/5 4/6\n");
    return "<shape type='obj'><string name='filename' value='a.obj'/><ref id='m'/></shape>";
}

TEST(Findings, TexelsOfSeveralPlaces) {
    const TemporaryFolder folder;
    const std::string material = textured(folder, 16);
    const auto overlap = [&](const char* second) {
        return mentions(findings_of(folder, kSky + material + two_triangles(folder, second)),
                        "overlap in texture coordinates");
    };
    EXPECT_TRUE(overlap("vt 0 0\nvt 0.4 0\nvt 0.4 0.4\n"));
    EXPECT_FALSE(overlap("vt 0 0\nvt 0.4 0.4\nvt 0 0.4\n"));  // neighbours along an edge
    EXPECT_FALSE(overlap("vt 1 1\nvt 1.4 1\nvt 1.4 1.4\n"));  // meant: the texture repeats
    EXPECT_FALSE(overlap("vt 0.5 0.5\nvt 0.9 0.5\nvt 0.9 0.9\n"));
    // Many shapes are said in one sentence.
    const std::string mesh = two_triangles(folder, "vt 0 0\nvt 0.4 0\nvt 0.4 0.4\n");
    EXPECT_TRUE(mentions(findings_of(folder, kSky + material + mesh + mesh + mesh),
                         "3 shapes, 'shape_0' most of all: 100 % of its texture"));
}

TEST(Findings, TexelsOfSeveralMeshes) {
    const TemporaryFolder folder;
    const std::string first = kSky + textured(folder, 16);
    const auto square = [&](const std::string& id, const std::string& u0, const std::string& u1) {
        write_text(folder, id + ".obj",
                   "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt " + u0 + " 0\nvt " + u1 + " 0\nvt " +
                       u1 + " 1\nvt " + u0 + " 1\nf 1/1 2/2 3/3 4/4\n");
        return "<shape type='obj' id='" + id + "'><string name='filename' value='" + id +
               ".obj'/><ref id='m'/></shape>";
    };
    const auto findings = [&](const std::string& shapes) {
        std::string all;
        for (const std::string& text : findings_of(folder, first + shapes))
            if (text.find("of the used texels of") != std::string::npos) all += text;
        return all;
    };
    const std::string whole = square("A", "0", "1");
    const std::string end = " of the used texels of m.reflectance.data, which get one value ";
    EXPECT_EQ(findings(whole), "");
    EXPECT_EQ(findings(whole + square("B", "0", "1")),
              "shapes 'A' and 'B' share 100 %" + end + "together");
    EXPECT_EQ(findings(whole + square("B", "3", "3.25")),
              "shapes 'A' and 'B' share 25 %" + end + "together")
        << "the texture repeats";
    EXPECT_EQ(findings(square("B", "0", "0.5") + square("C", "0.5", "1")), "")
        << "halves of an atlas";
    EXPECT_EQ(findings(whole + square("B", "0.95", "1")), "") << "a seam";
    EXPECT_EQ(
        findings(square("B", "0", "0.5") + square("C", "0", "0.5") + square("D", "0.5", "0.75") +
                 square("E", "0", "0.5") + square("F", "0", "0.5")),
        "shapes 'B', 'C' and 2 others share 67 %" + end + "together");
    EXPECT_EQ(findings("<shape type='shapegroup' id='g'>" + whole +
                       "</shape><shape type='instance'><ref id='g'/></shape><shape "
                       "type='instance'><ref id='g'/></shape>"),
              "")
        << "instances show one mesh";
}

/// Seconds of processor time, which nothing else takes from this process.
double seconds_so_far() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Grids as fine as those of a few would take 25 times as long.
TEST(Findings, TexelsOfVeryManyMeshesTakeAsLongAsThoseOfSome) {
    const TemporaryFolder folder;
    const std::string material = textured(folder, 16);
    const auto seconds_of = [&](std::size_t count) {
        std::string shapes;
        for (std::size_t i = 0; i < count; ++i)
            shapes += fmt::format("<shape type='rectangle' id='r{}'><ref id='m'/></shape>\n", i);
        const LoadedScene loaded = load_text(folder, kCamera + kSky + material + shapes);
        const double begin = seconds_so_far();
        Findings findings;
        check_overlaps(loaded.scene, findings);
        check_shared_textures(loaded.scene, findings);
        EXPECT_EQ(findings, Findings{"shapes 'r0', 'r1' and " + count_text(count - 2, "other") +
                                     " share 100 % of the used texels of m.reflectance.data, which "
                                     "get one value together"});
        return seconds_so_far() - begin;
    };
    const double some = seconds_of(200), many = seconds_of(5000);
    EXPECT_LT(many, 5 * some);
}

TEST(Findings, TexelsOfSeveralMeshesAreOneSentenceOfAllParameters) {
    const TemporaryFolder folder;
    const std::string texture =
        "'><string name='filename' value='t.exr'/><transform name='to_uv'><scale x='";
    const auto material = [&](const std::string& id, const std::string& scale) {
        return "<bsdf type='diffuse' id='" + id + "'><texture type='bitmap' name='reflectance" +
               texture + scale + "'/></transform></texture></bsdf>";
    };
    const auto panel = [](const std::string& id, const std::string& bsdf) {
        return "<shape type='rectangle' id='" + id + "'><ref id='" + bsdf + "'/></shape>";
    };
    textured(folder, 16);
    EXPECT_TRUE(mentions(
        findings_of(folder, kSky + material("p", "1") + material("q", "0.5") + panel("a", "p") +
                                panel("b", "q") + panel("c", "q") + panel("d", "p")),
        "shapes 'a' and 'd' share 100 % of the used texels of p.reflectance.data, which get one "
        "value together; so it is with 1 other parameter"));
    EXPECT_FALSE(mentions(findings_of(folder, kSky + material("p", "1") + material("q", "0.5") +
                                                  panel("a", "p") + panel("b", "q")),
                          "of the used texels of"))
        << "textures of one file are two";
}

TEST(Findings, MoreTexelsThanPixels) {
    const TemporaryFolder folder;
    const auto too_many = [&](int size) {
        return mentions(findings_of(folder, kSky + textured(folder, size) +
                                                "<shape type='rectangle'><ref id='m'/></shape>"),
                        "over 100 texels for each pixel that shows them");
    };
    EXPECT_TRUE(too_many(512));
    EXPECT_FALSE(too_many(64));
}

TEST(Findings, ParametersThatNoViewShows) {
    const TemporaryFolder folder;
    const std::string hidden =
        "<shape type='rectangle'><transform name='to_world'><translate "
        "z='9'/></transform><ref id='m'/></shape>";
    const LoadedScene loaded = load_text(folder, kCamera + kSky + textured(folder, 16) + hidden);
    const TracedScene traced = prepare(loaded.scene);
    EXPECT_TRUE(mentions(inspect(traced).findings, "not show 1 of the 1 parameters"));
    PerspectiveCamera back = loaded.scene.camera;
    back.to_world = look_at({0, 0, 12}, {0, 0, 0}, {0, 1, 0});
    const TracedScene other = with_camera(traced, make_camera_rays(back, traced.film), traced.film);
    const std::vector<TracedScene> views{other};
    EXPECT_FALSE(mentions(inspect(traced, views).findings, "parameters"));
}

/// A wall that fills the scene's own picture.
LoadedScene load_wall(const TemporaryFolder& folder) {
    return load_text(folder, kCamera + kSky + textured(folder, 16) +
                                 "<shape type='rectangle'><transform name='to_world'><scale "
                                 "value='20'/></transform><ref id='m'/></shape>");
}

/// The scene's own camera sees the front, those of the pictures the back, or nothing.
TEST(Findings, OfPicturesAreWhatTheirCamerasSee) {
    const TemporaryFolder folder;
    const LoadedScene loaded = load_wall(folder);
    const TracedScene traced = prepare(loaded.scene);
    const auto at = [&](double z, const Vec3<double>& target, int width) {
        PerspectiveCamera camera = loaded.scene.camera;
        camera.to_world = look_at({0, 0, z}, target, {0, 1, 0});
        Film film = traced.film;
        film.width = film.crop_width = width;
        return with_camera(traced, make_camera_rays(camera, film), film);
    };
    const SceneFacts own = inspect(traced);
    EXPECT_EQ(own.parameters[0].seen, 1);
    EXPECT_FALSE(mentions(own.findings, "black back"));
    const TracedScene behind = at(-5, {0, 0, 0}, 32), away = at(5, {0, 0, 9}, 96);
    const SceneFacts both = inspect(traced, std::vector{behind, away});
    EXPECT_EQ(both.parameters[0].seen, 0.25) << "each pixel counts the same";
    EXPECT_TRUE(mentions(both.findings, "25 % of the pictures show the black back"));
    EXPECT_TRUE(mentions(inspect(traced, std::vector{behind}).findings,
                         "100 % of the picture shows the black back"));
    const SceneFacts none = inspect(traced, std::vector{away});
    EXPECT_EQ(none.parameters[0].seen, 0);
    EXPECT_TRUE(mentions(none.findings, "not show 1 of the 1 parameters (0.0 % above)"));
    EXPECT_FALSE(mentions(none.findings, "no shape at all"));
}

/// A wall, farther away than a far plane, and in a fisheye's picture that is larger than its field.
TEST(Findings, OfPicturesEndWithTheClippingPlanesAndTheField) {
    const TemporaryFolder folder;
    const LoadedScene loaded = load_wall(folder);
    const TracedScene traced = prepare(loaded.scene);
    const auto seen = [&](const CameraRays& rays) {
        const std::vector<TracedScene> views{with_camera(traced, rays, traced.film)};
        return inspect(traced, views).parameters[0].seen;
    };
    PerspectiveCamera camera = loaded.scene.camera;
    EXPECT_EQ(seen(make_camera_rays(camera, traced.film)), 1);
    camera.far_clip = 4;  // the rectangle is at 5
    EXPECT_EQ(seen(make_camera_rays(camera, traced.film)), 0);
    const Camera fisheye{32,
                         32,
                         3,
                         3,
                         16,
                         16,
                         {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 5, 0, 0, 0, 1},
                         {LensKind::kFisheye, {}}};
    // Up to atan(4) from the axis, 4 pixels from the middle; its field ends at 9.4 pixels.
    EXPECT_NEAR(seen(make_camera_rays(fisheye, 0.01f, 1000)), 0.05, 0.01);
}

TEST(Findings, SurfacesThatAreInsideOut) {
    const TemporaryFolder folder;
    const auto inside_out = [&](const std::string& content) {
        return mentions(
            findings_of(folder, kSky + "<shape type='cube' id='c'>" + content + "</shape>"),
            "shape 'c' is closed and its normals point inwards");
    };
    const std::string flipped = "<boolean name='flip_normals' value='true'/>";
    EXPECT_FALSE(inside_out(""));
    EXPECT_TRUE(inside_out(flipped));
    EXPECT_FALSE(inside_out(flipped + "<bsdf type='twosided'><bsdf type='diffuse'/></bsdf>"));
    EXPECT_FALSE(inside_out(flipped + "<transform name='to_world'><scale value='20'/></transform>"))
        << "a room";
}

TEST(Findings, GlassThatIsInsideOut) {
    const TemporaryFolder folder;
    const auto findings = [&](const std::string& bsdf) {
        std::string all;
        for (const std::string& text :
             findings_of(folder, kSky +
                                     "<shape type='cube'><boolean name='flip_normals' "
                                     "value='true'/>" +
                                     bsdf + "</shape>"))
            if (text.find("normals point inwards") != std::string::npos) all += text;
        return all;
    };
    const auto is_glass = [&](const std::string& bsdf) {
        return findings(bsdf).find("inside and outside of its glass") != std::string::npos;
    };
    EXPECT_TRUE(is_glass("<bsdf type='dielectric'/>"));
    EXPECT_TRUE(is_glass("<bsdf type='roughdielectric'/>"));
    EXPECT_TRUE(
        is_glass("<bsdf type='principled'><float name='spec_trans' value='0.5'/>"
                 "</bsdf>"));
    for (const char* thin : {"thindielectric", "principledthin", "null"})
        EXPECT_EQ(findings(std::string("<bsdf type='") + thin + "'/>"), "") << thin;
}

/// Of a blend what its weight lets show.
TEST(Findings, BlendsAreAskedForTheirParts) {
    const TemporaryFolder folder;
    const auto mask = [](const char* opacity) {
        return std::string("<bsdf type='mask'><float name='opacity' value='") + opacity +
               "'/><bsdf type='diffuse'/></bsdf>";
    };
    const auto blend = [](const char* weight) {
        return std::string("<bsdf type='blendbsdf'><float name='weight' value='") + weight +
               "'/><bsdf type='thindielectric'/><bsdf type='diffuse'/></bsdf>";
    };
    const std::string wall =
        "<transform name='to_world'><scale value='20'/><rotate y='1' angle='180'/></transform>";
    for (const auto& make : {std::function<std::string(const char*)>(mask),
                             std::function<std::string(const char*)>(blend)})
        for (const auto& [weight, is_solid] :
             {std::pair("0", false), std::pair("0.5", false), std::pair("1", true)}) {
            const std::string material = make(weight);
            EXPECT_EQ(mentions(findings_of(folder, "<shape type='cube'>" + material +
                                                       "</shape><emitter type='spot'/>"),
                               "lets no light through"),
                      is_solid)
                << material;
            EXPECT_EQ(mentions(findings_of(folder, kSky + "<shape type='rectangle'>" + wall +
                                                       material + "</shape>"),
                               "black back"),
                      is_solid)
                << material;
        }
}

TEST(Findings, NormalsThatContradictTheirTriangles) {
    const TemporaryFolder folder;
    const auto contradict = [&](const char* normal) {
        write_text(
            folder, "n.obj",
            std::string("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nvn 0 0 ") + normal + "\nf 1//1 2//1 3//1\n");
        return mentions(findings_of(folder, kSky + "<shape type='obj'><string name='filename' "
                                                   "value='n.obj'/></shape>"),
                        "1 of 1 triangles face away from the normals");
    };
    EXPECT_FALSE(contradict("1"));
    EXPECT_TRUE(contradict("-1"));
}

TEST(Findings, LightsThatAreWalledIn) {
    const TemporaryFolder folder;
    const auto walled = [&](const std::string& shape, const std::string& emitter) {
        return mentions(findings_of(folder, shape + emitter), "lets no light through");
    };
    const std::string lamp = "<emitter type='point'><point name='position' y='0.2'/></emitter>";
    const std::string spot = "<emitter type='spot'/>";
    EXPECT_TRUE(walled("<shape type='sphere' id='s'/>", lamp));
    EXPECT_TRUE(walled("<shape type='cube'/>", spot));
    EXPECT_FALSE(walled("<shape type='sphere'><point name='center' y='3'/></shape>", lamp));
    EXPECT_FALSE(
        walled("<shape type='cube'><transform name='to_world'><scale "
               "value='20'/></transform></shape>",
               lamp))
        << "a room with the camera inside";
    EXPECT_TRUE(
        walled("<shape type='cube'/><shape type='rectangle'><transform "
               "name='to_world'><scale value='0.5'/></transform><emitter "
               "type='area'/></shape>",
               ""));
    EXPECT_FALSE(walled("<shape type='rectangle'><emitter type='area'/></shape>", ""));
    const auto stuck = [&](const char* x) {  // its middle triangle is in the cube
        write_text(folder, "lamp.obj",
                   std::string("v -0.5 0 0\nv 0 0 0\nv 0 0.5 0\nv ") + x + " 0 0\nv " + x +
                       " 0.5 0\nf 1 2 3\nf 1 2 3\nf 2 4 5\n");
        return walled(
            "<shape type='cube'/><shape type='obj'><string name='filename' "
            "value='lamp.obj'/><emitter type='area'/></shape>",
            "");
    };
    EXPECT_TRUE(stuck("0.5"));
    EXPECT_FALSE(stuck("9")) << "a part of the lamp is outside";
}

TEST(Findings, LightsWithTrianglesThatHaveNoArea) {
    const TemporaryFolder folder;
    const std::string corners = "v -0.5 -0.5 0\nv 0.5 -0.5 0\nv 0.5 0.5 0\nv -0.5 0.5 0\n";
    const auto walled = [&](const char* faces) {
        write_text(folder, "light.obj", corners + faces);
        return mentions(findings_of(folder,
                                    "<shape type='cube'/><shape type='obj'><string name='filename' "
                                    "value='light.obj'/><emitter type='area'/></shape>"),
                        "lets no light through");
    };
    EXPECT_TRUE(walled("f 1 2 3\nf 1 1 3\nf 1 3 4\n"));
    EXPECT_TRUE(walled("f 1 2 3\nf 1 1 3\n"));
}

TEST(Findings, ValuesBeyondWhatTheirInputTakes) {
    const TemporaryFolder folder;
    const auto outside = [&](const char* name, float value) {
        write_image(folder.path / "t.exr", make_image(2, 2, 1, value));
        return mentions(
            findings_of(folder, kSky +
                                    "<shape type='rectangle'><bsdf type='principledthin'><texture "
                                    "type='bitmap' name='" +
                                    name +
                                    "'><string name='filename' value='t.exr'/></texture></bsdf>" +
                                    "</shape>"),
            "4 of 4 values lie outside of");
    };
    EXPECT_TRUE(outside("spec_trans", 1.5f));
    EXPECT_FALSE(outside("diff_trans", 1.5f));
    EXPECT_TRUE(outside("diff_trans", 2.5f));
}

TEST(Findings, AGoodSceneHasNone) {
    const TemporaryFolder folder;
    const LoadedScene loaded =
        load_text(folder, kCamera + kSky + textured(folder, 16) +
                              "<shape type='rectangle'><ref id='m'/></shape><shape type='sphere'>"
                              "<float name='radius' value='0.5'/></shape>");
    const SceneFacts facts = inspect(prepare(loaded.scene));
    EXPECT_TRUE(facts.findings.empty()) << facts.findings[0];
    EXPECT_GT(facts.seconds, 0);
}

}  // namespace
}  // namespace burnish
