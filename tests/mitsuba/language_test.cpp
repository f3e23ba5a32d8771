// The scene language: what each construct means, and what is said about it.
#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <numbers>

#include "image/image.h"
#include "mitsuba/spectra.h"
#include "mitsuba/temporary_scene.h"
#include "mitsuba/xml.h"

namespace burnish {
namespace {

const std::string kLight =
    "<emitter type='constant'/><sensor type='perspective'/><integrator type='direct'/>";

const Sphere& first_sphere(const LoadedScene& loaded) {
    return std::get<Sphere>(loaded.scene.shapes.at(0).geometry);
}

TEST(Language, DefaultsLongestNameFirstAndTheCommandLineWins) {
    const TemporaryFolder folder;
    const std::string text =
        kLight +
        "<default name='r' value='1'/><default name='rad' value='$r.5'/><default name='r' "
        "value='9'/>"
        "<shape type='sphere' id='\\$x'><float name='radius' value='$rad'/></shape>";
    EXPECT_EQ(first_sphere(load_text(folder, text)).radius, 1.5f);
    EXPECT_EQ(load_text(folder, text).scene.shapes[0].id, "$x");
    EXPECT_EQ(first_sphere(load_text(folder, text, {{{"rad", "4"}}, 0, 0})).radius, 4.0f);
    EXPECT_TRUE(load_text(folder, text, {{{"rad", "4"}}, 0, 0}).warnings.empty());
    EXPECT_TRUE(error_of(folder.path / "scene.xml", {{{"other", "4"}}, 0, 0})
                    .ends_with("a value is given for $other, which the scene does not have; "
                               "expected one for $r, $rad"));
}

TEST(Language, TheLongestNameIsOneThatTheTextBeginsWith) {
    const TemporaryFolder folder;
    const auto id_of = [&](const std::string& text) {
        return load_text(folder,
                         kLight +
                             "<default name='r' value='1'/><default name='rad' value='2'/>"
                             "<default name='ra_' value='3'/><default name='raw' value='4'/>"
                             "<default name='s' value='5'/><shape type='sphere' id='" +
                             text + "'/>")
            .scene.shapes.at(0)
            .id;
    };
    EXPECT_EQ(id_of("$rax$rad0$raw$ra$rz$s"), "1ax2041a1z5");
    EXPECT_EQ(id_of("$ra_$rac"), "31ac");
}

TEST(Language, ForwardReferencesAliasesPathsAndIncludes) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path / "assets");
    write_image(folder.path / "assets/t.png", make_image(2, 2, 3, 0.5f));
    write_text(
        folder, "assets/m.xml",
        "<scene version='3.0.0'><bsdf type='diffuse' id='late'><texture type='bitmap' "
        "name='reflectance'><string name='filename' value='t.png'/></texture></bsdf></scene>");
    const LoadedScene loaded = load_text(
        folder, kLight +
                    "<shape type='rectangle'><ref id='other'/></shape><alias id='late' as='other'/>"
                    "<path value='assets'/><include filename='m.xml'/>");
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings[0];
    ASSERT_EQ(loaded.scene.parameters.size(), 1u);
    EXPECT_EQ(loaded.scene.parameters[0].name, "late.reflectance.data");
    EXPECT_EQ(loaded.scene.materials.size(), 1u);
}

/// As in Mitsuba 3.9.1, but for what only the folder of an included scene has.
TEST(Language, TheLastPathIsLookedThroughFirst) {
    const TemporaryFolder folder;
    const auto write = [&](const std::string& name, float value) {
        std::filesystem::create_directories((folder.path / name).parent_path());
        write_image(folder.path / name, make_image(1, 1, 3, value));
    };
    write("t.exr", 0.1f), write("a/t.exr", 0.2f), write("b/t.exr", 0.3f), write("c/t.exr", 0.4f);
    write("c/own.exr", 0.5f);
    const auto texel = [&](const std::string& name) {
        return "<bsdf type='diffuse' id='m'><texture type='bitmap' name='reflectance'><string "
               "name='filename' value='" +
               name + "'/></texture></bsdf>";
    };
    write_text(folder, "c/t.xml", "<scene version='3.0.0'>" + texel("t.exr") + "</scene>");
    write_text(folder, "c/own.xml", "<scene version='3.0.0'>" + texel("own.exr") + "</scene>");
    const std::string a = "<path value='a'/>", b = "<path value='b'/>";
    for (const auto& [text, value] :
         std::vector<std::pair<std::string, float>>{{texel("t.exr"), 0.1f},
                                                    {a + texel("t.exr"), 0.2f},
                                                    {a + b + texel("t.exr"), 0.3f},
                                                    {a + b + a + texel("t.exr"), 0.2f},
                                                    {texel("t.exr") + a, 0.2f},
                                                    {"<include filename='c/t.xml'/>", 0.1f},
                                                    {"<include filename='c/own.xml'/>", 0.5f}}) {
        const Scene scene = load_text(folder, kLight + text).scene;
        EXPECT_EQ(linear_image(std::get<Bitmap>(scene.textures.at(0))).values.at(0), value) << text;
    }
}

/// Under any of its names.
TEST(Language, AFolderIsLookedThroughOnceAndFewAreNamed) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder.path / "0");
    std::filesystem::create_directory_symlink("0", folder.path / "link");
    std::string paths;
    for (int i = 0; i < 300; ++i)
        paths += "<path value='.'/><path value='0'/><path value='0/../link/.'/>";
    const std::clock_t begin = std::clock();
    EXPECT_EQ(load_text(folder, kLight + paths).scene.emitters.size(), 1u);
    EXPECT_LT(std::clock() - begin, CLOCKS_PER_SEC);
    paths = "<path value='.'/>";
    for (int i = 0; i < 64; ++i) {
        const std::filesystem::path named = folder.path / std::to_string(i);
        std::filesystem::create_directories(named);
        paths += "<path value='" + named.string() + "'/>";
    }
    const std::string error = test::error_of([&] { load_text(folder, kLight + paths); });
    EXPECT_NE(error.find("<path> names more than 64 folders"), std::string::npos) << error;
}

TEST(Language, ANameIsLookedForOnceWhileTheFoldersStay) {
    const TemporaryFolder folder;
    write_text(folder, "t.txt", "");
    mitsuba::Document document;
    document.top_folder = std::filesystem::canonical(folder.path);
    for (int i = 0; i < 1000; ++i) {
        const std::filesystem::path none = folder.path / std::to_string(i);
        document.search_folders.push_back({none, none});
    }
    const mitsuba::Place place{(folder.path / "scene.xml").string(), 1, 1};
    const std::clock_t begin = std::clock();
    for (int i = 0; i < 20'000; ++i)
        EXPECT_EQ(mitsuba::resolve_file(document, place, "t.txt").filename(), "t.txt");
    EXPECT_LT(std::clock() - begin, 2 * CLOCKS_PER_SEC);
}

TEST(Language, APathBetweenTwoIncludesOfANameChangesWhatTheSecondMeans) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder.path / "a");
    write_text(folder, "m.xml", "<scene version='3.0.0'><bsdf type='diffuse' id='m'/></scene>");
    write_text(folder, "a/m.xml", "<scene version='3.0.0'><bsdf type='diffuse' id='n'/></scene>");
    const std::string include = "<include filename='m.xml'/>";
    const Scene scene =
        load_text(folder, kLight + include + "<path value='a'/>" + include +
                              "<shape type='cube'><ref id='m'/></shape><shape type='cube'><ref "
                              "id='n'/></shape>")
            .scene;
    EXPECT_EQ(scene.materials.size(), 2u);
}

/// As in Mitsuba 3.9.1.
TEST(Language, OfANameTheLastElementOfTheSceneCounts) {
    const TemporaryFolder folder;
    const LoadedScene twice =
        load_text(folder, kLight +
                              "\n<shape type='sphere' id='a' name='Cube'/>\n<shape type='disk' "
                              "id='b' name='Cube'/><shape type='sphere' id='c'/>");
    ASSERT_EQ(twice.scene.shapes.size(), 2u);
    EXPECT_EQ(twice.scene.shapes[0].id, "b");
    EXPECT_EQ(twice.scene.shapes[1].id, "c");
    ASSERT_EQ(twice.warnings.size(), 1u);
    EXPECT_TRUE(mentions(twice.warnings, "scene.xml:3:1: the shape named \"Cube\" is left out: "));
    EXPECT_TRUE(mentions(twice.warnings, "scene.xml:4:1 has the same name"));

    const std::string sphere = "<shape type='sphere' id='s'/>",
                      cameras =
                          "<sensor type='perspective' id='c' name='k'/>"
                          "<sensor type='perspective' id='d' name='k'/>";
    const LoadedScene seen = load_text(
        folder, "<emitter type='constant'/><integrator type='direct'/>" + sphere + cameras);
    ASSERT_EQ(seen.scene.sensors.size(), 1u);
    EXPECT_EQ(seen.scene.sensors[0].id, "d");

    const LoadedScene kinds = load_text(
        folder, kLight + sphere + "<shape type='disk' name='x'/><emitter type='point' name='x'/>");
    EXPECT_EQ(kinds.scene.shapes.size(), 1u);
    EXPECT_EQ(kinds.scene.emitters.size(), 2u);

    const LoadedScene referred =
        load_text(folder, kLight +
                              "<bsdf type='diffuse' id='m' name='x'/>"
                              "<shape type='sphere' name='x'><ref id='m'/></shape>");
    EXPECT_EQ(referred.scene.shapes.size(), 1u);
    EXPECT_TRUE(referred.warnings.empty()) << "a bsdf is where it is referred to";

    const LoadedScene integrators = load_text(
        folder, "<emitter type='constant'/><sensor type='perspective'/>" + sphere +
                    "<integrator type='direct' name='i'/><integrator type='direct' name='i'>"
                    "<boolean name='hide_emitters' value='true'/></integrator>");
    EXPECT_TRUE(integrators.scene.hide_emitters);
    EXPECT_FALSE(mentions(integrators.notes, "a second integrator"));
}

TEST(Language, UnknownParametersAreOneWarning) {
    const TemporaryFolder folder;
    const LoadedScene loaded =
        load_text(folder, kLight +
                              "\n<shape type='sphere'><float name='size' value='1'/>\n<string "
                              "name='hue' value='red'/></shape>");
    ASSERT_EQ(loaded.warnings.size(), 1u);
    EXPECT_NE(
        loaded.warnings[0].find(
            "scene.xml:3:1: shape \"sphere\" does not know \"size\" (line 3), \"hue\" (line 4)"),
        std::string::npos)
        << loaded.warnings[0];
}

TEST(Language, IntegratorsThatMeanDirectLight) {
    const TemporaryFolder folder;
    const std::string base = "<emitter type='constant'/><sensor type='perspective'/>";
    EXPECT_TRUE(mentions(load_text(folder, base).notes, "no integrator: \"direct\" is taken"));
    EXPECT_TRUE(mentions(load_text(folder, base + "<integrator type='$integrator'/>").notes,
                         "$integrator open"));
    const LoadedScene prb =
        load_text(folder, base +
                              "<integrator type='prb'><integer name='max_depth' value='2'/>"
                              "<boolean name='hide_emitters' value='TRUE'/></integrator>");
    EXPECT_TRUE(mentions(prb.notes, "max_depth 2 is direct light"));
    EXPECT_TRUE(prb.scene.hide_emitters);
    EXPECT_TRUE(mentions(
        load_text(folder,
                  base + "<integrator type='direct'><integer name='emitter_samples' value='4'/>"
                         "</integrator>")
            .warnings,
        "\"emitter_samples\" is ignored"));
}

TEST(Language, PathsAreAsDeepAsTheirIntegratorSays) {
    const TemporaryFolder folder;
    const std::string base = "<emitter type='constant'/><sensor type='perspective'/>";
    const auto depths_of = [&](const std::string& integrator) {
        const Scene scene = load_text(folder, base + integrator).scene;
        return std::pair(scene.max_depth, scene.rr_depth);
    };
    EXPECT_EQ(depths_of("<integrator type='path'/>"), std::pair(kUnboundedDepth, 5));
    EXPECT_EQ(depths_of("<integrator type='prb'/>"), std::pair(6, 5));
    EXPECT_EQ(depths_of("<integrator type='path'><integer name='max_depth' value='7'/>"
                        "<integer name='rr_depth' value='3'/></integrator>"),
              std::pair(7, 3));
    EXPECT_EQ(depths_of("<integrator type='direct'/>").first, 2);
}

TEST(Language, AnAxisBesideAFocalLengthHasNoEffectAndItIsSaid) {
    const TemporaryFolder folder;
    const auto with = [&](const std::string& axis) {
        return load_text(folder,
                         "<emitter type='constant'/><integrator type='direct'/><sensor "
                         "type='perspective'><string name='focal_length' value='35mm'/>" +
                             axis + "</sensor>");
    };
    const LoadedScene loaded = with("<string name='fov_axis' value='y'/>");
    EXPECT_TRUE(mentions(loaded.notes, "\"fov_axis\" has no effect without \"fov\""));
    EXPECT_EQ(loaded.scene.camera.fov_x, with("").scene.camera.fov_x);
    EXPECT_TRUE(with("").notes.empty());
}

/// As in Mitsuba.
TEST(Language, AxesOfViewMayBeWrittenInCapitals) {
    const TemporaryFolder folder;
    const auto load = [&](const std::string& axis) {
        const std::string view =
            "<float name='fov' value='40'/><string name='fov_axis' value='" + axis + "'/>";
        return load_text(folder, "<emitter type='projector'>" + view +
                                     "<texture type='bitmap' name='irradiance'><string "
                                     "name='filename' value='wide.png'/></texture></emitter>"
                                     "<sensor type='perspective'>" +
                                     view + "</sensor>")
            .scene;
    };
    write_image(folder.path / "wide.png", make_image(6, 3, 3, 0.5f));
    for (const auto& [written, axis] :
         {std::pair{"Y", "y"}, {"Diagonal", "diagonal"}, {"SMALLER", "smaller"}}) {
        const Scene found = load(written), expected = load(axis);
        EXPECT_EQ(found.camera.fov_x, expected.camera.fov_x) << written;
        EXPECT_NE(found.camera.fov_x, 40) << written;
        EXPECT_EQ(std::get<ProjectorEmitter>(found.emitters[0]).fov_x,
                  std::get<ProjectorEmitter>(expected.emitters[0]).fov_x)
            << written;
    }
}

TEST(Language, LookAtWithoutUpRollsAsInMitsuba) {
    const TemporaryFolder folder;
    const float expected[3][3] = {// of Mitsuba 3.9.1
                                  {0.0349f, 0.9826f, -0.1826f},
                                  {-0.9303f, -0.0349f, -0.3651f},
                                  {-0.3651f, 0.1826f, 0.9129f}};
    for (const char* up : {"", "up='0,0,0'"}) {
        const Scene scene =
            load_text(folder,
                      std::string("<emitter type='constant'/><integrator type='direct'/><sensor "
                                  "type='perspective'><transform name='to_world'><lookat "
                                  "origin='1,2,-5' target='0,0,0' ") +
                          up + "/></transform></sensor>")
                .scene;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                EXPECT_NEAR(scene.camera.to_world(i, j), expected[i][j], 1e-4);
    }
}

LoadedScene load_old(const TemporaryFolder& folder, const std::string& children,
                     const char* version = "0.5.0") {
    return load_scene(
        write_text(folder, "old.xml",
                   std::string("<scene version='") + version + "'>" + children + "</scene>"));
}

TEST(Language, OldVersionsAreUpgradedAndItIsSaid) {
    const TemporaryFolder folder;
    for (const char* version : {"0.5.0", "0.6.0", "1.0.0"}) {
        const LoadedScene loaded = load_old(folder, kLight, version);
        EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings[0];
        EXPECT_TRUE(
            mentions(loaded.notes, std::string("version ") + version + " is upgraded: old names"));
    }
    EXPECT_TRUE(load_old(folder, kLight, "2.1.0").notes.empty());
    EXPECT_TRUE(load_old(folder, kLight, "3.5.0").notes.empty());
}

TEST(Language, OldNamesMeanTodays) {
    const TemporaryFolder folder;
    write_image(folder.path / "t.png", make_image(2, 2, 3, 0.5f));
    const LoadedScene loaded = load_old(
        folder,
        "<integrator type='direct'><boolean name='hideEmitters' value='true'/></integrator>"
        "<sensor type='perspective'><string name='fovAxis' value='y'/><transform name='toWorld'>"
        "<lookAt origin='0, 0, 4' target='0, 0, 0' up='0, 1, 0'/></transform><film "
        "type='ldrfilm'><boolean name='banner' value='false'/></film></sensor>"
        "<emitter type='constant'/>"
        "<shape type='rectangle'><bsdf type='diffuse' id='m'><texture type='bitmap' "
        "name='diffuseReflectance'><string name='filename' value='t.png'/><string "
        "name='filterType' value='ewa'/><string name='wrapMode' value='clamp'/><float "
        "name='uoffset' value='0.25'/><float name='uscale' value='3'/><float name='vscale' "
        "value='2'/></texture></bsdf></shape>"
        "<shape type='sphere'><bsdf type='diffuse'><srgb name='reflectance' "
        "value='#ff8000'/></bsdf></shape>");
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings[0];
    const Scene& scene = loaded.scene;
    EXPECT_TRUE(scene.hide_emitters);
    EXPECT_NEAR(transform_point(scene.camera.to_world, {0, 0, 0}).z, 4, 1e-6f);
    ASSERT_EQ(scene.parameters.size(), 1u);
    EXPECT_EQ(scene.parameters[0].name, "m.reflectance.data");
    const auto& bitmap = std::get<Bitmap>(scene.textures.at(0));
    EXPECT_EQ(bitmap.filter, TextureFilter::kBilinear);
    EXPECT_EQ(bitmap.wrap, TextureWrap::kClamp);
    EXPECT_EQ(bitmap.to_uv.m, (std::array<float, 6>{3, 0, 0.75f, 0, 2, 0}));
    const auto& orange =
        std::get<Diffuse>(scene[scene[scene.shapes[1].material].front]).reflectance.constant;
    EXPECT_EQ(orange.x, 1.0f);
    EXPECT_NEAR(orange.y, srgb_to_linear(128 / 255.0f), 1e-6f);
    EXPECT_EQ(orange.z, 0.0f);
}

TEST(Language, FiltersOfOldTexturesMayBeWrittenInCapitals) {
    const TemporaryFolder folder;
    write_image(folder.path / "t.png", make_image(2, 2, 3, 0.5f));
    for (const std::string filter : {"EWA", "Trilinear", "bilinear", "Nearest"}) {
        const LoadedScene loaded = load_old(
            folder, kLight +
                        "<texture type='bitmap' id='t'><string name='filename' value='t.png'/>"
                        "<string name='filterType' value='" +
                        filter + "'/></texture>");
        EXPECT_EQ(std::get<Bitmap>(loaded.scene.textures.at(0)).filter,
                  filter == "Nearest" ? TextureFilter::kNearest : TextureFilter::kBilinear)
            << filter;
    }
}

/// The texture itself, one that is referred to, and what they mean in the language of today.
TEST(Language, TheScaleOfATextureInABumpMapIsThatOfTheMap) {
    const TemporaryFolder folder;
    write_image(folder.path / "t.png", make_image(2, 2, 1, 0.5f));
    const auto texture = [](const std::string& attributes) {
        return "<texture type='bitmap'" + attributes +
               "><string name='filename' value='t.png'/><boolean name='raw' value='true'/>"
               "</texture>";
    };
    const auto load = [&](const std::string& heights, const char* version) {
        return load_old(folder,
                        kLight + texture(" id='t'") + "<shape type='sphere'><bsdf type='bumpmap'>" +
                            heights + "<bsdf type='diffuse'/></bsdf></shape>",
                        version);
    };
    const std::string scale = "<float name='scale' value='2'/>", ref = "<ref id='t'/>";
    const auto check = [](const LoadedScene& loaded, std::int32_t id) {
        EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings[0];
        const Scene& scene = loaded.scene;
        const auto& map = scene[scene.shapes.at(0).material].normals;
        ASSERT_TRUE(map);
        EXPECT_EQ(map->height_scale, 2.0f);
        EXPECT_EQ(map->texture.value, id);
    };
    for (const std::string& inside : {scale + ref, ref + scale})
        check(load("<texture type='scale'>" + inside + "</texture>", "0.6.0"), 0);
    check(load("<texture type='scale'>" + scale + texture("") + "</texture>", "0.6.0"), 1);
    check(load(scale + ref, "3.0.0"), 0);
}

TEST(Language, TextBetweenElementsIsLeftOut) {
    const TemporaryFolder folder;
    const LoadedScene loaded = load_text(
        folder, kLight + "\n<shape type='disk'>> todo <bsdf type='diffuse'/><![CDATA[x]]></shape>");
    EXPECT_EQ(loaded.scene.shapes.size(), 1u);
    ASSERT_EQ(loaded.warnings.size(), 1u) << "one for each element";
    EXPECT_TRUE(mentions(loaded.warnings, "scene.xml:3:1: the text \"> todo \" inside <shape>"));
}

TEST(Language, PassesThatVolpathDoesNotCountAreSaid) {
    const TemporaryFolder folder;
    const auto warns = [&](const std::string& type, const std::string& depth,
                           const std::string& bsdf) {
        const LoadedScene loaded = load_text(
            folder, "<sensor type='perspective'/><emitter type='constant'/><integrator type='" +
                        type + "'><integer name='max_depth' value='" + depth +
                        "'/></integrator><shape type='disk'>" + bsdf + "</shape>");
        return mentions(loaded.warnings, "goes straight through");
    };
    const std::string null = "<bsdf type='null'/>",
                      mask =
                          "<bsdf type='mask'><float name='opacity' value='0.5'/><bsdf "
                          "type='diffuse'/></bsdf>";
    for (const std::string& bsdf : {null, mask, std::string("<bsdf type='thindielectric'/>")})
        EXPECT_TRUE(warns("volpath", "3", bsdf)) << bsdf;
    EXPECT_FALSE(warns("volpath", "-1", null));
    EXPECT_FALSE(warns("path", "3", null));
    EXPECT_FALSE(warns("volpath", "3", "<bsdf type='diffuse'/>"));
    EXPECT_FALSE(
        warns("volpath", "3", "<bsdf type='diffuse'/></shape>" + null + "<shape type='disk'>"))
        << "nothing shows it";
}

TEST(Language, LeftoversOfOldScenesNeedNoWord) {
    const TemporaryFolder folder;
    write_image(folder.path / "t.png", make_image(2, 2, 3, 0.5f));
    const LoadedScene loaded =
        load_old(folder,
                 "<integrator type='volpath_simple'><integer name='maxDepth' value='9'/><boolean "
                 "name='strictNormals' value='true'/></integrator><sensor type='perspective'><film "
                 "type='hdrfilm'><boolean name='attachLog' value='false'/></film></sensor><emitter "
                 "type='constant'/><shape type='rectangle'><bsdf type='bumpmap'><texture "
                 "type='scale'><float name='scale' value='0.25'/><texture type='bitmap'><string "
                 "name='filename' value='t.png'/><float name='gamma' value='1.0'/><float "
                 "name='maxAnisotropy' value='8'/></texture></texture><bsdf type='diffuse'/></bsdf>"
                 "</shape>",
                 "0.6.0");
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings[0];
    EXPECT_TRUE(mentions(loaded.notes, "integrator \"volpath_simple\" is read as \"path\""));
    const Scene& scene = loaded.scene;
    EXPECT_EQ(scene.max_depth, 9);
    const auto& normals = scene[scene.shapes[0].material].normals;
    ASSERT_TRUE(normals);
    EXPECT_EQ(normals->height_scale, 0.25f);
    EXPECT_TRUE(std::get<Bitmap>(scene[normals->texture]).raw);
}

TEST(Language, SpectraHaveTheColoursOfMitsuba) {
    const std::string text = "400:0.04, 450:0.3 500:0.6, 550:0.2, 600:0.8, 650:0.5, 700:0.7";
    const auto expect = [&](const std::string& pairs, mitsuba::SpectrumUse use,
                            const Rgbf& expected) {
        const Rgbf color = mitsuba::rgb_of_spectrum(pairs, use, {});
        EXPECT_LT(length(color - expected), 3e-6f * length(expected))
            << color.x << ' ' << color.y << ' ' << color.z;
    };
    using enum mitsuba::SpectrumUse;
    expect(text, kReflectance, {0.70166641f, 0.40957525f, 0.31264392f});
    expect(text, kEmission, {0.82704353f, 0.38975587f, 0.27332368f});
    expect("400:1.6, 700:0.2", kIndex, {0.46674028f, 0.93257242f, 1.4013948f});
    expect("400:1.6, 700:0.2", kReflectance, {0.46674028f, 0.93257242f, 1});
    expect("500:1, 501:1", kReflectance, {0, 0.0060877786f, 0.0020894764f});
    expect("360:0.5, 830:0.5", kEmission, {0.60244131f, 0.47411445f, 0.45463338f});
}

TEST(Language, SpectraOfLightsAndMetalsAreReadAsSuch) {
    const TemporaryFolder folder;
    const Scene scene =
        load_text(folder,
                  "<emitter type='point'><spectrum name='intensity' value='400:0, 500:8, 600:15.6, "
                  "700:18.4'/></emitter><shape type='sphere'><bsdf type='conductor'><spectrum "
                  "name='eta' value='400:1.6, 700:0.2'/><spectrum name='k' value='400:1.9, "
                  "700:3'/></bsdf></shape>")
            .scene;
    const Rgbf light = std::get<PointEmitter>(scene.emitters.at(0)).intensity;
    EXPECT_NEAR(light.x, 20.7108f, 1e-4f);
    EXPECT_NEAR(light.z, 2.77115f, 1e-4f);
    const auto& metal = std::get<Conductor>(scene[scene[scene.shapes[0].material].front]);
    EXPECT_NEAR(metal.index.eta.z, 1.40139f, 1e-5f);
    EXPECT_NEAR(metal.index.k.x, 2.77571f, 1e-5f);
}

TEST(Language, SpectraInFilesAreThoseOfTheirPairs) {
    const TemporaryFolder folder;
    write_text(folder, "lamp.spd", "# nm value\n400 0\n500 8 # blue\r\n\n600 15.6\n700\t18.4");
    const auto intensity = [&](const std::string& attribute) {
        const LoadedScene loaded =
            load_text(folder, "<emitter type='point'><spectrum name='intensity' " + attribute +
                                  "/></emitter><shape type='sphere'/>");
        return std::get<PointEmitter>(loaded.scene.emitters.at(0)).intensity;
    };
    const Rgbf pairs = intensity("value='400:0, 500:8, 600:15.6, 700:18.4'");
    EXPECT_EQ(intensity("filename='lamp.spd'"), pairs);
    write_text(folder, "lamp.spd",
               "\xEF\xBB\xBF"
               "400 0\n500 8\n600 15.6\n700 18.4");
    EXPECT_EQ(intensity("filename='lamp.spd'"), pairs);
    write_text(folder, "lamp.spd", "400 1\n500 1 2\n");
    const std::string message = error_of(folder.path / "scene.xml");
    EXPECT_NE(message.find("lamp.spd:2:1: found 3 numbers, expected a wavelength and a value"),
              std::string::npos)
        << message;
}

TEST(Language, IncludedFilesAreUpgradedByTheirOwnVersion) {
    const TemporaryFolder folder;
    write_text(folder, "old_part.xml",
               "<scene version='0.6.0'><shape type='rectangle'><boolean name='flipNormals' "
               "value='true'/></shape></scene>");
    const LoadedScene loaded =
        load_text(folder, kLight +
                              "<include filename='old_part.xml'/><shape type='rectangle'>"
                              "<boolean name='flipNormals' value='true'/></shape>");
    ASSERT_EQ(loaded.warnings.size(), 1u);
    EXPECT_TRUE(mentions(loaded.warnings, "does not know \"flipNormals\""));
}

TEST(Language, PrincipledFlagsAndEta) {
    const TemporaryFolder folder;
    const auto principled = [&](const std::string& parameters) {
        const LoadedScene loaded =
            load_text(folder, kLight + "<bsdf type='principled' id='m'>" + parameters + "</bsdf>");
        return std::get<Principled>(loaded.scene.bsdfs.at(0));
    };
    EXPECT_NEAR(principled("").eta, 1.5f, 1e-6f);
    EXPECT_NEAR(principled("<float name='specular' value='0'/>").eta, 1.0f, 1e-6f);
    EXPECT_EQ(principled("<float name='eta' value='1'/><float name='spec_trans' value='0.5'/>").eta,
              1.001f);
    EXPECT_EQ(principled("<float name='eta' value='1.00000001'/><float name='spec_trans' "
                         "value='0.5'/>")
                  .eta,
              1.001f)
        << "no other float";
    EXPECT_EQ(principled("<float name='eta' value='1'/>").eta, 1.0f);
    EXPECT_NEAR(principled("<float name='specular' value='0'/><float name='spec_trans' "
                           "value='0.5'/>")
                    .eta,
                2 / (1 - std::sqrt(0.08 * 1e-3)) - 1, 1e-6)
        << "as if it were 0.001";
    EXPECT_EQ(principled("")[PrincipledScalar::kRoughness].constant, 0.5f);
    EXPECT_EQ(
        principled("<rgb name='roughness' value='0.9 0.9 0.9'/>")[PrincipledScalar::kRoughness]
            .constant,
        0.9f);
    EXPECT_FALSE(principled("<float name='sheen' value='0'/>").has_sheen);
    EXPECT_TRUE(principled("<float name='sheen' value='0.1'/>").has_sheen);
    EXPECT_TRUE(principled("<texture type='checkerboard' name='sheen'/>").has_sheen);
    const Principled tinted = principled("<rgb name='spec_tint' value='1 0 0'/>");
    EXPECT_FLOAT_EQ(tinted[PrincipledScalar::kSpecTint].constant, 1 / 3.0f);
    EXPECT_TRUE(tinted.has_spec_tint);
}

TEST(Language, ShapesWithoutMaterials) {
    const TemporaryFolder folder;
    const Scene scene =
        load_text(folder,
                  kLight + "<shape type='cube'/><shape type='disk'><emitter type='area'/></shape>")
            .scene;
    EXPECT_EQ(
        std::get<Diffuse>(scene[scene[scene.shapes[0].material].front]).reflectance.constant.x,
        0.5f);
    EXPECT_EQ(
        std::get<Diffuse>(scene[scene[scene.shapes[1].material].front]).reflectance.constant.x,
        0.0f);
    EXPECT_EQ(std::get<AreaEmitter>(scene[scene.shapes[1].emitter]).shape.value, 1);
}

TEST(Language, SpheresUnderTransforms) {
    const TemporaryFolder folder;
    const auto sphere = [&](const std::string& content) {
        return first_sphere(
            load_text(folder, kLight + "<shape type='sphere'>" + content + "</shape>"));
    };
    const Sphere moved = sphere(
        "<point name='center' x='1'/><float name='radius' value='2'/><transform name='to_world'>"
        "<scale value='3'/><rotate z='1' angle='90'/></transform>");
    EXPECT_NEAR(moved.center.y, 3, 1e-6f);
    EXPECT_NEAR(moved.radius, 6, 1e-6f);
    EXPECT_FALSE(moved.flip_normals);
    EXPECT_TRUE(sphere("<transform name='to_world'><scale x='-1'/></transform>").flip_normals);
    EXPECT_FALSE(sphere("<boolean name='flip_normals' value='true'/><transform "
                        "name='to_world'><scale x='-1'/></transform>")
                     .flip_normals);
}

TEST(Language, TexturesOfEveryEncoding) {
    const TemporaryFolder folder;
    Image image = make_image(1, 1, 3, 0.25f);
    write_image(folder.path / "a.png", image, false);
    write_image(folder.path / "a.exr", image);
    const auto bitmap = [&](const std::string& content) {
        const LoadedScene loaded = load_text(
            folder, kLight +
                        "<bsdf type='diffuse' id='m'><texture type='bitmap' name='reflectance'>" +
                        content + "</texture></bsdf>");
        return std::get<Bitmap>(loaded.scene.textures.at(0));
    };
    const Bitmap png =
        bitmap("<string name='filename' value='a.png'/><string name='wrap_mode' value='clamp'/>");
    EXPECT_EQ(png.width, 2);  // one pixel is padded to two
    EXPECT_EQ(png.height, 2);
    EXPECT_EQ(png.wrap, TextureWrap::kClamp);
    EXPECT_EQ(png.codes, std::vector<std::uint8_t>(12, 64));
    EXPECT_NEAR(linear_image(png).values[0], srgb_to_linear(64 / 255.0f), 1e-7f);
    const Bitmap raw =
        bitmap("<string name='filename' value='a.png'/><boolean name='raw' value='true'/>");
    EXPECT_EQ(linear_image(raw).values[11], 64 / 255.0f);
    const Bitmap exr = bitmap("<string name='filename' value='a.exr'/>");
    EXPECT_EQ(exr.values, std::vector<float>(12, 0.25f));

    std::filesystem::copy_file(BURNISH_TEST_DATA "/tables/texture_gray16.png",
                               folder.path / "b.png");
    const std::string deep = "<string name='filename' value='b.png'/>";
    const Bitmap codes = bitmap(deep + "<boolean name='raw' value='true'/>"),
                 decoded = bitmap(deep);
    ASSERT_EQ(codes.values.size(), 24u);
    for (std::size_t i = 0; i < 24; ++i)
        EXPECT_EQ(decoded.values[i], srgb_to_linear(codes.values[i]));
    EXPECT_NE(decoded.values, codes.values);
}

TEST(Language, BoardsHaveMitsubasColours) {
    const TemporaryFolder folder;
    const LoadedScene loaded =
        load_text(folder, kLight +
                              "<bsdf type='diffuse' id='m'><texture type='checkerboard' "
                              "name='reflectance'/></bsdf>");
    const auto& board = std::get<Checkerboard>(loaded.scene.textures.at(0));
    EXPECT_EQ(board.color0, (Rgbf{0.4f, 0.4f, 0.4f}));
    EXPECT_EQ(board.color1, (Rgbf{0.2f, 0.2f, 0.2f}));
}

/// A scene whose film has these elements.
std::string with_film(const std::string& elements) {
    return "<emitter type='constant'/><integrator type='direct'/><sensor type='perspective'><film "
           "type='hdrfilm'>" +
           elements + "</film></sensor>";
}

constexpr const char* kFilmSize =
    "<integer name='width' value='100'/><integer name='height' value='50'/>";

TEST(Language, FilmSizeCanBeReplaced) {
    const TemporaryFolder folder;
    const std::string text =
        with_film(std::string(kFilmSize) + "<integer name='crop_width' value='10'/>");
    const LoadedScene loaded = load_text(folder, text, {{}, 64, 32});
    EXPECT_EQ(loaded.scene.film.crop_width, 64);
    EXPECT_EQ(loaded.scene.film.height, 32);
    EXPECT_TRUE(mentions(loaded.notes, "its crop window is dropped"));
    EXPECT_EQ(load_text(folder, text).scene.film.crop_width, 10);
}

/// As in Mitsuba: a crop window that has one size given has the other of the film.
TEST(Language, ACropWindowWithoutASizeHasThatOfTheFilm) {
    const TemporaryFolder folder;
    const auto load = [&](const std::string& crop) {
        return load_text(folder, with_film(std::string(kFilmSize) +
                                           "<integer name='crop_offset_x' value='30'/>" + crop))
            .scene.film;
    };
    const Film film = load("<integer name='crop_width' value='70'/>");
    EXPECT_EQ(film.crop_x, 30);
    EXPECT_EQ(film.crop_width, 70);
    EXPECT_EQ(film.crop_height, 50);
    EXPECT_THROW(load(""), InputError);
    EXPECT_THROW(load("<integer name='crop_width' value='70'/><integer name='crop_offset_y' "
                      "value='1'/>"),
                 InputError);
}

TEST(Language, PixelsOfXyzAreReadAsRgbAndItIsSaid) {
    const TemporaryFolder folder;
    const auto load = [&](const std::string& format) {
        return load_text(folder, with_film("<string name='pixel_format' value='" + format + "'/>"));
    };
    EXPECT_TRUE(load("rgb").notes.empty());
    const LoadedScene xyz = load("XYZ"), xyza = load("xyza");
    EXPECT_EQ(xyz.scene.film.pixel_format, PixelFormat::kRgb);
    EXPECT_TRUE(mentions(xyz.notes, "pixel_format \"xyz\" is read as \"rgb\""));
    EXPECT_EQ(xyza.scene.film.pixel_format, PixelFormat::kRgba);
    EXPECT_TRUE(mentions(xyza.notes, "pixel_format \"xyza\" is read as \"rgba\""));
}

TEST(Language, ABorderOfSamplesIsWarnedOf) {
    const TemporaryFolder folder;
    const auto warnings = [&](const std::string& value) {
        return load_text(folder, with_film("<boolean name='sample_border' value='" + value + "'/>"))
            .warnings;
    };
    EXPECT_TRUE(warnings("false").empty());
    EXPECT_TRUE(mentions(warnings("true"), "sample_border is read as false"));
}

TEST(Language, MatricesAndPoints) {
    const TemporaryFolder folder;
    const Scene scene =
        load_text(folder, kLight +
                              "<emitter type='point'><transform name='to_world'><matrix value='0 1 "
                              "0 1 0 0 0 1 0'/>"
                              "<translate value='1, 2, 3'/></transform></emitter>"
                              "<emitter type='point'><point name='position' y='4'/></emitter>"
                              "<emitter type='point'><transform name='to_world'>"
                              "<translate value='1, 2, 3'/><matrix value='0 1 0 0 0 1 2 0 0'/>"
                              "</transform></emitter>")
            .scene;
    EXPECT_EQ(std::get<PointEmitter>(scene.emitters[1]).position, (Vec3f{1, 2, 3}));
    EXPECT_EQ(std::get<PointEmitter>(scene.emitters[2]).position, (Vec3f{0, 4, 0}));
    EXPECT_EQ(std::get<PointEmitter>(scene.emitters[3]).position, (Vec3f{2, 3, 2})) << "by rows";
}

TEST(Language, NumbersTooCloseToZeroAreZero) {
    const TemporaryFolder folder;
    const LoadedScene loaded = load_text(
        folder, kLight + "<shape type='sphere'><point name='center' x='1e-999' y='2'/></shape>");
    EXPECT_EQ(first_sphere(loaded).center.x, 0);
    EXPECT_EQ(first_sphere(loaded).center.y, 2);
}

TEST(Language, APlusMayStandBeforeANumber) {
    const TemporaryFolder folder;
    const LoadedScene loaded =
        load_text(folder, with_film("<integer name='width' value='+40'/>") +
                              "<shape type='sphere'><float name='radius' value='+2'/></shape>");
    EXPECT_EQ(loaded.scene.film.width, 40);
    EXPECT_EQ(first_sphere(loaded).radius, 2);
}

TEST(Language, ASceneWithoutSensorIsSeenWhole) {
    const TemporaryFolder folder;
    const LoadedScene loaded = load_text(folder, "<emitter type='constant'/><shape type='cube'/>");
    EXPECT_TRUE(mentions(loaded.notes, "no sensor"));
    const Vec3f eye = transform_point(loaded.scene.camera.to_world, {0, 0, 0});
    EXPECT_LT(eye.z, -2);
    EXPECT_EQ(loaded.scene.camera.near_clip, 0.01f);
    const PerspectiveCamera near =
        load_text(folder,
                  "<shape type='cube'><transform name='to_world'><scale value='0.001'/></transform>"
                  "</shape>")
            .scene.camera;
    EXPECT_LT(near.near_clip, 1e-4f) << "the cube begins 0.0024 in front of the camera";
    EXPECT_GT(near.near_clip, 0.0f);
    EXPECT_TRUE(mentions(load_text(folder, "<shape type='cube'/>").warnings, "no emitter"));

    // A box that is wide, low, and not around the origin: its near side fills the picture.
    const PerspectiveCamera camera =
        load_text(folder,
                  "<shape type='cube'><transform name='to_world'><scale x='3' y='0.5' z='1'/>"
                  "<translate x='10' y='20' z='30'/></transform></shape>")
            .scene.camera;
    const double distance = 3 / std::tan(camera.fov_x / 2 * std::numbers::pi / 180);
    const Vec3f seen_from = transform_point(camera.to_world, {0, 0, 0});
    EXPECT_NEAR(seen_from.x, 10, 1e-4f);
    EXPECT_NEAR(seen_from.y, 20, 1e-4f);
    EXPECT_NEAR(seen_from.z, 29 - distance, 1e-4f);
    EXPECT_GT(camera.far_clip, distance + 2);
}

}  // namespace
}  // namespace burnish
