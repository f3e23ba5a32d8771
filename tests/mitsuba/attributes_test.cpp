// Mesh attributes that lights show, and lights that shapes refer to.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <array>

#include "image/image.h"
#include "mitsuba/temporary_scene.h"
#include "paths/one_ray.h"

namespace burnish {
namespace {

const std::string kUnlit = "<sensor type='perspective'/><integrator type='direct'/>\n";

std::string colors_named(const std::string& name) {
    return "<texture type='mesh_attribute' name='" + name +
           "'><string name='name' value='vertex_color'/></texture>";
}

std::string picture_named(const std::string& name) {
    return "<texture type='bitmap' name='" + name +
           "'><string name='filename' value='map.exr'/></texture>";
}

/// A square around the origin whose corners have this red, green and blue.
void write_square(const TemporaryFolder& folder, const std::string& name,
                  const std::array<Rgbf, 4>& colors) {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
        "float z\nproperty float u\nproperty float v\nproperty float r\nproperty float g\nproperty "
        "float b\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    for (std::size_t i = 0; i < 4; ++i)
        text += fmt::format("{} {} 0 0.5 0.5 {} {} {}\n", i == 1 || i == 2 ? 1 : -1, i < 2 ? -1 : 1,
                            colors[i].x, colors[i].y, colors[i].z);
    write_text(folder, name, text + "4 0 1 2 3\n");
}

std::string square(const std::string& name, const std::string& children) {
    return "<shape type='ply'><string name='filename' value='" + name + "'/>" + children +
           "</shape>\n";
}

/// What the emitter of the first shape shows at a point of it.
Rgbf radiance_at(const Scene& scene, float x, float y) {
    const TracedScene traced = prepare(scene);
    const Vec3f origin{x, y, 2}, direction{0, 0, -1};
    const Hit hit = first_hit(traced.geometry->accel, origin, direction);
    const Surface s = surface_at(scene, traced.geometry->triangles, hit, origin, direction);
    const auto& emitter = std::get<AreaEmitter>(scene[scene.shapes.at(0).emitter]);
    return eval_color({scene.textures, {}}, {emitter.radiance, emitter.texture}, s.uv);
}

TEST(MeshAttributes, LightsShowThemWithinTriangles) {
    const TemporaryFolder folder;
    write_square(folder, "a.ply",
                 {Rgbf{0.1f, 0.2f, 3}, {0.9f, 0.4f, 1}, {0.2f, 0.8f, 6}, {0.3f, 0.5f, 7}});
    const LoadedScene loaded =
        load_text(folder, kUnlit + square("a.ply", "<emitter type='area'>" +
                                                       colors_named("radiance") + "</emitter>"));
    EXPECT_TRUE(loaded.warnings.empty());
    // Triangle 0 1 2, weights 0.25, 0.5, 0.25
    const Rgbf color = radiance_at(loaded.scene, 0.5f, -0.5f);
    EXPECT_NEAR(color.x, 0.25f * 0.1f + 0.5f * 0.9f + 0.25f * 0.2f, 1e-4f);
    EXPECT_NEAR(color.z, 0.25f * 3 + 0.5f * 1 + 0.25f * 6, 1e-3f);
}

TEST(MeshAttributes, ALightThatSeveralShapesReferToShowsThatOfEach) {
    const TemporaryFolder folder;
    const Rgbf red{1, 0, 0}, blue{0, 0, 1};
    write_square(folder, "red.ply", {red, red, red, red});
    write_square(folder, "blue.ply", {blue, blue, blue, blue});
    const std::string light = "<emitter type='area'><ref name='radiance' id='t'/></emitter>";
    std::string texture = colors_named("radiance");
    texture.insert(8, " id='t'");
    const Scene scene =
        load_text(folder, kUnlit + texture + square("red.ply", light) + square("blue.ply", light))
            .scene;
    ASSERT_EQ(scene.emitters.size(), 2u);
    const auto shown = [&](std::size_t i) {
        const Texture& t = scene[std::get<AreaEmitter>(scene.emitters[i]).texture];
        const auto& values = std::get<Bitmap>(t).values;
        return Rgbf{values.at(0), values.at(1), values.at(2)};
    };
    EXPECT_EQ(shown(0), red);
    EXPECT_EQ(shown(1), blue);
}

TEST(MeshAttributes, OthersBesideThemAreRefusedInLightsToo) {
    const TemporaryFolder folder;
    write_image(folder.path / "map.exr", make_image(2, 2, 3, 0.5f));
    write_square(folder, "a.ply", {});
    const auto mixed = [&](const std::string& bsdf, const std::string& light) {
        return kUnlit + "<shape type='sphere'><emitter type='area'/></shape>\n" +
               square("a.ply", "<bsdf type='diffuse'>" + bsdf + "</bsdf><emitter type='area'>" +
                                   light + "</emitter>");
    };
    for (const std::string& children :
         {mixed(colors_named("reflectance"), picture_named("radiance")),
          mixed(picture_named("reflectance"), colors_named("radiance"))}) {
        try {
            load_text(folder, children);
            ADD_FAILURE() << "nothing was said";
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what())
                          .find("scene.xml:4:1: a shape whose bsdf or emitter reads a mesh "
                                "attribute beside another texture is not supported yet"),
                      std::string::npos)
                << error.what();
        }
        LoadOptions options;
        options.ignore_unsupported = true;
        const LoadedScene rest = load_text(folder, children, options);
        EXPECT_EQ(rest.scene.shapes.size(), 1u);
        EXPECT_EQ(rest.scene.emitters.size(), 1u);
        EXPECT_EQ(rest.warnings.size(), 1u);
    }
}

TEST(SharedLights, ShapesInsideOthersReferToThem) {
    const TemporaryFolder folder;
    const LoadedScene loaded = load_text(
        folder, kUnlit +
                    "<emitter type='area' id='e'/><shape type='merge'><shape "
                    "type='merge'><shape type='cube'><ref id='e'/></shape></shape></shape>");
    EXPECT_EQ(loaded.scene.shapes.size(), 1u);
    EXPECT_EQ(loaded.scene.emitters.size(), 1u);
}

TEST(MeshAttributes, ALightWithoutAShapeHasNone) {
    const TemporaryFolder folder;
    write_square(folder, "a.ply", {});
    const auto file = write_text(folder, "scene.xml",
                                 "<scene version='3.0.0'>" + kUnlit + square("a.ply", "") +
                                     "<emitter type='projector'>" + colors_named("irradiance") +
                                     "</emitter></scene>");
    EXPECT_NE(error_of(file).find("the shape has no attribute \"vertex_color\""), std::string::npos)
        << error_of(file);
}

}  // namespace
}  // namespace burnish
