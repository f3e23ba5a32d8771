// Plugins that are one colour.
#include <gtest/gtest.h>

#include "mitsuba/temporary_scene.h"

namespace burnish {
namespace {

struct Colored {
    const char* name;
    const char* element;  ///< without the name that it has as a parameter
    Rgbf color;           ///< that Mitsuba 3.9.1 renders in scalar_rgb, as a light and as a surface
};

class ColorPlugins : public testing::TestWithParam<Colored> {};

std::string with_name(std::string element, const std::string& name) {
    return element.insert(element.find(' '), " name='" + name + "'");
}

TEST_P(ColorPlugins, AreColoursOfLightsAndSurfaces) {
    const TemporaryFolder folder;
    const std::string element = GetParam().element;
    const LoadedScene loaded = load_text(
        folder, "<sensor type='perspective'/><integrator type='direct'/><emitter type='constant'>" +
                    with_name(element, "radiance") +
                    "</emitter><shape type='cube'><bsdf type='diffuse'>" +
                    with_name(element, "reflectance") + "</bsdf></shape>");
    EXPECT_TRUE(loaded.warnings.empty());
    const Scene& scene = loaded.scene;
    EXPECT_EQ(std::get<ConstantEmitter>(scene.emitters.at(0)).radiance, GetParam().color);
    EXPECT_EQ(std::get<Diffuse>(scene.bsdfs.at(0)).reflectance.constant, GetParam().color);
    EXPECT_TRUE(scene.textures.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Table, ColorPlugins,
    testing::Values(
        Colored{"Uniform",
                "<spectrum type='uniform'><float name='value' value='0.7'/></spectrum>",
                {0.7f, 0.7f, 0.7f}},
        Colored{"Daylight", "<spectrum type='d65'/>", {1, 1, 1}},
        Colored{"ColouredDaylight",
                "<spectrum type='d65'><float name='scale' value='0.5'/><rgb name='color' "
                "value='0.5 0.25 0.125'/></spectrum>",
                {0.25f, 0.125f, 0.0625f}},
        Colored{"Srgb",
                "<texture type='srgb'><rgb name='color' value='0.1 0.2 0.3'/></texture>",
                {0.1f, 0.2f, 0.3f}},
        Colored{"RawNumber",
                "<texture type='rawconstant'><float name='value' value='0.3'/></texture>",
                {0.3f, 0.3f, 0.3f}},
        Colored{
            "RawVector",
            "<spectrum type='rawconstant'><vector name='value' value='0.1, 0.2, 0.3'/></spectrum>",
            {0.1f, 0.2f, 0.3f}}),
    [](const auto& colored) { return std::string(colored.param.name); });

TEST(ColorReferences, AreReadWhereTheyAreReferredTo) {
    const TemporaryFolder folder;
    const LoadedScene loaded = load_text(
        folder,
        "<sensor type='perspective'/><integrator type='direct'/><emitter type='constant'/><texture "
        "type='srgb' id='t'><rgb name='color' value='0.5'/></texture><shape type='cube'><bsdf "
        "type='principled'><ref name='base_color' id='t'/><ref name='roughness' "
        "id='t'/></bsdf></shape>");
    EXPECT_TRUE(loaded.warnings.empty());
    const auto& bsdf = std::get<Principled>(loaded.scene.bsdfs.at(0));
    EXPECT_EQ(bsdf.base_color.constant.y, 0.5f);
    EXPECT_EQ(bsdf[PrincipledScalar::kRoughness].constant, 0.5f);
}

}  // namespace
}  // namespace burnish
