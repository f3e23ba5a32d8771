// Scenes written again with other values: a folder that works by itself and means the same.
#include "mitsuba/write.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/variant.h"
#include "file_bytes.h"
#include "scene/constants.h"
#include "temporary_scene.h"

namespace burnish {

namespace {

namespace fs = std::filesystem;

constexpr const char* kBody = R"(
  <default name="light" value="6"/> <default name="map" value="plain.exr"/>
  <path value="maps"/>
  <sensor type="perspective"><film type="hdrfilm"><integer name="width" value="20"/>
    <integer name="height" value="10"/><integer name="crop_width" value="5"/></film></sensor>
  <include filename="parts/materials.xml"/>
  <alias id="mat-a" as="other"/>
  <shape type="rectangle" id="one"><ref id="other"/></shape>
  <shape type="rectangle" id="two"><ref id="mat-b"/></shape>
  <shape type="ply" id="three"><string name="filename" value="mesh.ply"/></shape>
  <emitter type="point"><rgb name="intensity" value="$light"/></emitter>)";

constexpr const char* kMaterials = R"(<scene version="3.0.0">
  <texture type="bitmap" id="shared"><string name="filename" value="$map"/>
    <string name="wrap_mode" value="mirror"/><string name="format" value="fp16"/>
    <boolean name="raw" value="true"/>
    <transform name="to_uv"><scale x="3" y="2"/></transform></texture>
  <bsdf type="principled" id="mat-a"><ref id="shared" name="roughness"/>
    <float name="metallic" value="0.25"/></bsdf>
  <bsdf type="twosided" id="mat-b"><bsdf type="principled"><ref id="shared" name="roughness"/>
    <texture type="bitmap" name="base_color"><string name="filename" value="$map"/></texture></bsdf>
  </bsdf>
</scene>)";

constexpr const char* kTriangle =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

struct Written {
    TemporaryFolder folder;
    LoadedScene before;
    fs::path copy = folder.path / "copy";

    explicit Written(const LoadOptions& options = {}) {
        write_text(folder, "given/parts/materials.xml", kMaterials);
        write_text(folder, "given/parts/mesh.ply", kTriangle);
        write_text(folder, "given/mesh.ply", kTriangle);
        fs::create_directories(folder.path / "given/maps");
        write_image(folder.path / "given/maps/plain.exr", make_image(4, 4, 1, 0.5f));
        write_image(folder.path / "given/maps/other.exr", make_image(4, 4, 1, 0.75f));
        before = load_scene(write_text(folder, "given/scene.xml",
                                       fmt::format("<scene version=\"3.0.0\">{}</scene>", kBody)),
                            options);
    }
    /// The copy, loaded where the given scene is no longer at hand.
    LoadedScene write(const std::vector<NewValue>& values) const {
        write_scene(before.source, values, copy);
        fs::rename(folder.path / "given", folder.path / "gone");
        return load_scene(copy / "scene.xml");
    }
    NewValue change(std::size_t parameter, std::variant<BitmapFile, float, Rgbf> value) const {
        return {before.source.parameters[parameter], std::move(value)};
    }
};

const Bitmap& bitmap(const LoadedScene& loaded, std::size_t parameter) {
    return std::get<Bitmap>(loaded.scene[loaded.scene.parameters[parameter].texture]);
}

TEST(Write, ACopyWorksByItselfAndMeansTheSame) {
    const Written written;
    const LoadedScene after = written.write({});
    const Scene &a = written.before.scene, &b = after.scene;
    EXPECT_TRUE(after.warnings.empty()) << after.warnings.front();
    ASSERT_EQ(a.parameters.size(), 3u);
    ASSERT_EQ(b.parameters.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(a.parameters[i].name, b.parameters[i].name);
        EXPECT_EQ(a.parameters[i].texture, b.parameters[i].texture);
        EXPECT_EQ(linear_image(bitmap(written.before, i)), linear_image(bitmap(after, i)));
        EXPECT_EQ(bitmap(written.before, i).to_uv.m, bitmap(after, i).to_uv.m);
    }
    ASSERT_EQ(b.shapes.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(a.shapes[i].material, b.shapes[i].material);
    EXPECT_EQ(mesh_of(b.shapes[2].geometry)->positions.size(), 3u);
    EXPECT_EQ(b.film.crop_width, 5);
    EXPECT_EQ(std::get<PointEmitter>(b.emitters[0]).intensity.x, 6);
}

TEST(Write, DefinitionsAndTheFilmsSizeAreKept) {
    const Written written({{{"light", "2.5"}, {"map", "other.exr"}}, 32, 16});
    const LoadedScene after = written.write({});
    EXPECT_EQ(std::get<PointEmitter>(after.scene.emitters[0]).intensity.x, 2.5f);
    EXPECT_EQ(linear_image(bitmap(after, 0)).values[0], 0.75f);
    EXPECT_EQ(after.scene.film.width, 32);
    EXPECT_EQ(after.scene.film.crop_width, 32);
    EXPECT_EQ(after.scene.film.crop_height, 16);
    EXPECT_FALSE(fs::exists(written.copy / "maps/plain.exr"));
}

TEST(Write, ASensorThatRefersToItsSamplerAloneGetsAFilmOfTheSize) {
    const TemporaryFolder folder;
    const fs::path file = write_text(folder, "given/scene.xml", R"(<scene version="3.0.0">
  <integrator type="direct"/><sampler type="independent" id="s"/>
  <sensor type="perspective"><ref id="s"/></sensor>
  <emitter type="constant"/></scene>)");
    const LoadedScene before = load_scene(file, {{}, 32, 16});
    EXPECT_TRUE(before.warnings.empty()) << before.warnings.front();
    write_scene(before.source, {}, folder.path / "copy");
    EXPECT_EQ(load_scene(folder.path / "copy/scene.xml").scene.film.width, 32);
}

/// What is left of an integrator, a sampler and a film in the scene of a result.
std::string rewritten(const std::string& integrator, const std::string& sampler,
                      const std::string& film) {
    const TemporaryFolder folder;
    const fs::path file =
        write_text(folder, "given/scene.xml",
                   "<scene version=\"3.0.0\">" + integrator + "<sensor type=\"perspective\">" +
                       sampler + film + "</sensor><emitter type=\"constant\"/></scene>");
    const LoadedScene before = load_scene(file);
    EXPECT_TRUE(before.warnings.empty()) << before.warnings.front();
    write_scene(before.source, {}, folder.path / "copy");
    return test::bytes_of(folder.path / "copy/scene.xml");
}

TEST(Write, PluginsThatMitsubaDoesNotHaveBecomeThoseThatTheyAreReadAs) {
    for (const char* type : {"volpath_simple", "bdpt", "mlt", "pssmlt", "erpt"}) {
        const std::string text =
            rewritten(std::string("<integrator type=\"") + type +
                          "\"><boolean name=\"strict_normals\" value=\"true\"/></integrator>",
                      "", "<film type=\"hdrfilm\"/>");
        EXPECT_NE(text.find("<integrator type=\"path\""), std::string::npos) << text;
        EXPECT_EQ(text.find("strict"), std::string::npos) << text;
    }
    for (const char* type : {"sobol", "halton", "hammersley"}) {
        const std::string text =
            rewritten("<integrator type=\"direct\"/>",
                      std::string("<sampler type=\"") + type +
                          "\"><integer name=\"scramble\" value=\"1\"/></sampler>",
                      "<film type=\"ldrfilm\"><float name=\"gamma\" value=\"2.2\"/><boolean "
                      "name=\"high_quality_edges\" value=\"true\"/></film>");
        for (const char* old : {type, "scramble", "ldrfilm", "gamma", "edges"})
            EXPECT_EQ(text.find(old), std::string::npos) << old << " in " << text;
    }
}

TEST(Write, ParametersThatMitsubaDoesNotHaveAreGone) {
    const std::string gone =
        rewritten("<integrator type=\"direct\"/>",
                  R"(<sampler type="independent"><boolean name="jitter" value="true"/></sampler>
           <string name="focal_length" value="35mm"/><string name="fov_axis" value="y"/>)",
                  R"(<film type="hdrfilm"><string name="file_format" value="mfilm"/></film>)");
    for (const char* old : {"jitter", "fov_axis", "mfilm"})
        EXPECT_EQ(gone.find(old), std::string::npos) << old << " in " << gone;
    const std::string kept =
        rewritten("<integrator type=\"direct\"/>",
                  R"(<sampler type="stratified"><boolean name="jitter" value="true"/></sampler>
           <float name="fov" value="35"/><string name="fov_axis" value="y"/>)",
                  R"(<film type="hdrfilm"><string name="file_format" value="OpenEXR"/></film>)");
    for (const char* known : {"jitter", "fov_axis", "OpenEXR"})
        EXPECT_NE(kept.find(known), std::string::npos) << known << " in " << kept;
}

TEST(Write, OldScenesHaveNothingThatMitsubaRefuses) {
    const TemporaryFolder folder;
    const fs::path file = write_text(folder, "given/scene.xml", R"(<scene version="0.6.0">
  <integrator type="direct"><boolean name="strictNormals" value="true"/></integrator>
  <sensor type="perspective"><sampler type="sobol"/>
    <film type="ldrfilm"><boolean name="banner" value="false"/><float name="gamma" value="2.2"/>
    <string name="fileFormat" value="png"/><string name="pixelFormat" value="luminanceAlpha"/>
    </film></sensor>
  <bsdf type="diffuse" id="m"><srgb name="reflectance" value="#804020"/></bsdf>
  <shape type="rectangle"><ref id="m"/></shape><emitter type="constant"/>
  <shape type="rectangle"><emitter type="area"><texture type="bitmap" name="radiance">
    <string name="filename" value="t.exr"/><boolean name="cache" value="false"/>
    <float name="maxAnisotropy" value="8"/></texture></emitter></shape></scene>)");
    write_image(folder.path / "given/t.exr", make_image(2, 2, 3, 0.5f));
    const LoadedScene before = load_scene(file);
    write_scene(before.source, {}, folder.path / "copy");
    const std::string text = test::bytes_of(folder.path / "copy/scene.xml");
    for (const char* old : {"srgb", "strict", "sobol", "ldrfilm", "banner", "gamma", "file_format",
                            "luminanceAlpha", "cache", "anisotropy"})
        EXPECT_EQ(text.find(old), std::string::npos) << old << " in " << text;
    const LoadedScene after = load_scene(folder.path / "copy/scene.xml");
    EXPECT_EQ(after.scene.film.pixel_format, PixelFormat::kLuminanceAlpha);
    const auto color = [](const LoadedScene& loaded) {
        return value_of(loaded.scene, loaded.scene.constants.at(0)).values;
    };
    EXPECT_EQ(color(before), color(after));
    EXPECT_NEAR(color(after)[0], 0.2158605f, 1e-6f);
}

TEST(Write, ValuesStandWhereTheyAreReferredTo) {
    const TemporaryFolder folder;
    const fs::path file = write_text(folder, "given/scene.xml", R"(<scene version="3.0.0">
  <integrator type="direct"/><sensor type="perspective" version="3.0.0"/>
  <rgb id="red" name="red" value="0.6, 0.1, 0.2"/><float id="rough" name="rough" value="0.3"/>
  <srgb id="dark" value="0.5"/><spectrum id="light" value="2" unit="watt"/>
  <transform id="place" name="to_world"><translate id="step" name="step" x="3"/></transform>
  <string id="file" name="filename" value="t.exr"/><alias id="rough" as="other"/>
  <bsdf type="principled" id="m"><ref id="red" name="base_color"/>
    <ref id="rough" name="roughness"/><ref id="other" name="metallic"/></bsdf>
  <bsdf type="diffuse" id="n"><texture type="bitmap" name="reflectance">
    <ref id="file" name="filename"/></texture></bsdf>
  <shape type="rectangle"><ref id="place" name="to_world"/><ref id="m"/></shape>
  <shape type="rectangle"><ref id="n"/></shape>
  <emitter type="constant"><ref id="light" name="radiance"/></emitter></scene>)");
    write_image(folder.path / "given/t.exr", make_image(2, 2, 3, 0.5f));
    const LoadedScene before = load_scene(file);
    EXPECT_TRUE(before.warnings.empty()) << before.warnings.front();
    write_scene(before.source, {{{before.source.bsdfs.at(0), "roughness", -1}, 0.7f}},
                folder.path / "copy");
    const std::string text = test::bytes_of(folder.path / "copy/scene.xml");
    for (const char* gone : {"\"red\"", "\"rough\"", "\"dark\"", "\"light\"", "\"place\"",
                             "\"step\"", "\"file\"", "\"other\"", "unit"})
        EXPECT_EQ(text.find(gone), std::string::npos) << gone << " in " << text;
    EXPECT_EQ(text.find("version"), text.rfind("version")) << text;

    const LoadedScene after = load_scene(folder.path / "copy/scene.xml");
    EXPECT_TRUE(after.warnings.empty()) << after.warnings.front();
    const auto& bsdf = std::get<Principled>(after.scene.bsdfs.at(0));
    EXPECT_EQ(bsdf.base_color.constant, (Rgbf{0.6f, 0.1f, 0.2f}));
    EXPECT_EQ(bsdf[PrincipledScalar::kRoughness].constant, 0.7f);
    EXPECT_EQ(bsdf[PrincipledScalar::kMetallic].constant, 0.3f);
    EXPECT_EQ(linear_image(bitmap(after, 0)), make_image(2, 2, 3, 0.5f));
    const auto positions = [](const LoadedScene& loaded) {
        return mesh_of(loaded.scene.shapes.at(0).geometry)->positions;
    };
    EXPECT_EQ(positions(before), positions(after));
    const auto radiance = [](const LoadedScene& loaded) {
        return std::get<ConstantEmitter>(loaded.scene.emitters.at(0)).radiance;
    };
    EXPECT_EQ(radiance(before), radiance(after));
}

TEST(Write, ValuesThatAreReferredToWithoutANameAreGone) {
    const TemporaryFolder folder;
    const fs::path file = write_text(folder, "given/scene.xml", R"(<scene version="3.0.0">
  <integrator type="direct"/><float id="rough" name="rough" value="0.3"/>
  <bsdf type="principled" id="m"><ref id="rough"/></bsdf>
  <shape type="rectangle"><ref id="m"/></shape><emitter type="constant"/></scene>)");
    write_scene(load_scene(file).source, {}, folder.path / "copy");
    const std::string text = test::bytes_of(folder.path / "copy/scene.xml");
    EXPECT_EQ(text.find("<float"), std::string::npos) << text;
}

TEST(Write, ASharedTextureIsReplacedOnceForAll) {
    const Written written;
    const Image texels = make_image(8, 4, 1, 1.0f / 3);
    fs::create_directories(written.copy / "textures");
    write_image(written.copy / "textures/new.exr", texels);
    const LoadedScene after = written.write({written.change(0, BitmapFile{"textures/new.exr"})});
    EXPECT_EQ(after.scene.parameters[0].texture, after.scene.parameters[1].texture);
    const Bitmap& b = bitmap(after, 0);
    EXPECT_EQ(linear_image(b), texels);
    EXPECT_EQ(b.wrap, TextureWrap::kMirror);
    EXPECT_TRUE(b.raw);
    EXPECT_EQ(b.to_uv.m[0], 3);
    EXPECT_EQ(linear_image(bitmap(after, 2)), linear_image(bitmap(written.before, 2)));
    EXPECT_EQ(test::bytes_of(written.copy / "scene.xml").find("fp16"), std::string::npos);
}

TEST(Write, AConstantBecomesAnotherOneOrATexture) {
    const Written written;
    const Image texels = make_image(2, 2, 1, 0.1f);
    fs::create_directories(written.copy);
    write_image(written.copy / "metal.exr", texels);
    const ParameterSource a = written.before.source.parameters[0];
    const ParameterSource b = written.before.source.parameters[2];
    const LoadedScene after = written.write({
        {{a.bsdf, "metallic", -1}, BitmapFile{"metal.exr"}},
        {{b.bsdf, "metallic", -1}, 0.7f},  // the scene says nothing of it
        {{b.bsdf, "base_color", -1}, Rgbf{0.1f, 0.2f, 0.3f}},
    });
    const auto& first = std::get<Principled>(after.scene.bsdfs[0]);
    const auto& second = std::get<Principled>(after.scene.bsdfs[1]);
    EXPECT_EQ(after.scene.parameters[1].name, "mat-a.metallic.data");
    EXPECT_EQ(linear_image(bitmap(after, 1)), texels);
    EXPECT_TRUE(first[PrincipledScalar::kMetallic].texture);
    EXPECT_EQ(second[PrincipledScalar::kMetallic].constant, 0.7f);
    EXPECT_EQ(second.base_color.constant.y, 0.2f);
    EXPECT_FALSE(second.base_color.texture);
}

TEST(Write, AFileThatHasBecomeALinkOutOfTheSceneIsRefused) {
    const Written written;
    const fs::path map = written.folder.path / "given/maps/plain.exr";
    write_image(written.folder.path / "outside.exr", make_image(4, 4, 1, 0.5f));
    fs::remove(map);
    fs::create_symlink(written.folder.path / "outside.exr", map);
    const SceneSource& source = written.before.source;
    try {
        write_scene(source, {}, written.copy / "scene");
        ADD_FAILURE() << "nothing was said";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what())
                      .find("plain.exr: leads out of the scene's folder, expected a file inside "),
                  std::string::npos)
            << error.what();
    }
    EXPECT_THROW(files_of(source), InputError);
    EXPECT_THROW(file_of(source, source.parameters.at(0)), InputError);
    EXPECT_FALSE(fs::exists(written.copy / "outside.exr"));
}

TEST(Write, ADollarStaysOne) {
    const TemporaryFolder folder;
    const LoadedScene before = load_text(folder, R"(<default name="a" value="x"/>
      <emitter type="constant" id="\$a$a"/>)");
    write_scene(before.source, {}, folder.path / "copy");
    EXPECT_EQ(load_scene(folder.path / "copy/scene.xml").scene.emitter_ids,
              std::vector<std::string>{"$ax"});
}

}  // namespace

}  // namespace burnish
