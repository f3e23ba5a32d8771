// Materials that hold others: two sides, masks, blends and normal maps.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "burnish/error.h"
#include "burnish/renderer.h"
#include "mitsuba/temporary_scene.h"
#include "scene/blends.h"
#include "scene/constants.h"

namespace burnish {
namespace {

const std::string kFrame =
    "<sensor type='perspective'/><integrator type='direct'/><emitter type='constant'/>";
const std::string kRed = "<bsdf type='diffuse'><rgb name='reflectance' value='.8 .1 .1'/></bsdf>";
const std::string kMetal = "<bsdf type='roughconductor'/>";

/// map.exr is a texture of three channels beside the scene.
LoadedScene load_materials(const TemporaryFolder& folder, const std::string& bsdf) {
    write_image(folder.path / "map.exr", make_image(2, 2, 3, 0.5f));
    return load_text(folder, kFrame + "\n<shape type='rectangle'>" + bsdf + "</shape>");
}

std::string texture_named(const std::string& name) {
    return "<texture type='bitmap' name='" + name +
           "'><string name='filename' value='map.exr'/><boolean name='raw' "
           "value='true'/></texture>";
}

const Material& shown(const Scene& scene) { return scene[scene.shapes[0].material]; }

TEST(LayeredMaterials, AMaskBlendsNothingWithWhatItHolds) {
    const TemporaryFolder folder;
    const Scene scene = load_materials(folder,
                                       "<bsdf type='mask' id='m'><float name='opacity' "
                                       "value='0.3'/><bsdf type='twosided'>" +
                                           kRed + "</bsdf></bsdf>")
                            .scene;
    const Material& mask = shown(scene);
    EXPECT_EQ(mask.id, "m");
    ASSERT_TRUE(mask.blend);
    EXPECT_EQ(mask.blend->weight.constant, 0.3f);
    const auto& nothing = std::get<Dielectric>(scene[scene[mask.blend->first].front]);
    EXPECT_TRUE(nothing.thin && nothing.eta == 1);
    const Material& red = scene[mask.blend->second];
    EXPECT_TRUE(red.front && red.front == red.back);
    EXPECT_EQ(bsdfs_of(scene, scene.shapes[0].material).size(), 2u);
    ASSERT_EQ(scene.constants.size(), 2u);
    EXPECT_EQ(scene.constants[0].name, "m.nested_bsdf.brdf_0.reflectance.value");
    EXPECT_EQ(scene.constants[1].name, "m.opacity.value");
    EXPECT_EQ(value_of(scene, scene.constants[1]).values, std::vector<float>{0.3f});
    EXPECT_EQ(load_materials(folder, "<bsdf type='mask'>" + kRed + "</bsdf>")
                  .scene.materials.back()
                  .blend->weight.constant,
              0.5f);
}

TEST(LayeredMaterials, ABlendShowsTheSecondByItsShare) {
    const TemporaryFolder folder;
    const Scene scene =
        load_materials(folder, "<bsdf type='blendbsdf' id='b'>" + texture_named("weight") + kRed +
                                   kMetal + "</bsdf>")
            .scene;
    const MaterialBlend& blend = *shown(scene).blend;
    EXPECT_TRUE(bool(blend.weight.texture));
    EXPECT_TRUE(std::holds_alternative<Diffuse>(scene[scene[blend.first].front]));
    EXPECT_TRUE(std::holds_alternative<RoughConductor>(scene[scene[blend.second].front]));
    EXPECT_EQ(textures_of(scene, scene.shapes[0].material).size(), 1u);
}

/// A blend is read for each material that shows it; in the file it has one weight.
TEST(LayeredMaterials, AWeightOfSeveralMaterialsIsOneUnknown) {
    const TemporaryFolder folder;
    const std::string blend =
        "<bsdf type='blendbsdf' id='b'><float name='weight' value='0.3'/>" + kRed + kMetal +
        "</bsdf><bsdf type='mask' id='m'><float name='opacity' value='0.3'/><ref id='b'/></bsdf>";
    Scene scene = load_text(folder, kFrame + blend +
                                        "<shape type='sphere'><ref id='b'/></shape>"
                                        "<shape type='sphere'><ref id='m'/></shape>")
                      .scene;
    const Parameter unknown = scene.parameters[require_parameter(scene, "b.weight")];
    EXPECT_EQ(unknown.name, "b.weight.value");
    EXPECT_EQ(shown(scene).blend->weight.texture, unknown.texture);
    const MaterialBlend& mask = *scene[scene.shapes[1].material].blend;
    EXPECT_FALSE(mask.weight.texture);
    EXPECT_EQ(scene[mask.second].blend->weight.texture, unknown.texture);
    const std::size_t other = require_parameter(scene, "m.nested_bsdf.weight");
    EXPECT_EQ(scene.parameters[other].texture, unknown.texture);
}

TEST(LayeredMaterials, TwoSidesOfABlendAreABlendOfTwoSides) {
    const TemporaryFolder folder;
    const Scene scene =
        load_materials(folder,
                       "<bsdf type='twosided'><bsdf type='blendbsdf'><float name='weight' "
                       "value='0.2'/>" +
                           kRed + kMetal + "</bsdf></bsdf>")
            .scene;
    const MaterialBlend& blend = *shown(scene).blend;
    for (const MaterialId id : {blend.first, blend.second})
        EXPECT_TRUE(scene[id].back && scene[id].back == scene[id].front);
}

TEST(LayeredMaterials, ANormalMapLiesOnAllThatItHolds) {
    const TemporaryFolder folder;
    const Scene plain =
        load_materials(folder, "<bsdf type='normalmap' id='n'>" + texture_named("normalmap") +
                                   "<bsdf type='twosided'>" + kRed + "</bsdf></bsdf>")
            .scene;
    ASSERT_TRUE(shown(plain).normals);
    EXPECT_TRUE(shown(plain).normals->flip_invalid && shown(plain).normals->shadowing);
    EXPECT_EQ(shown(plain).id, "n");
    const Scene blend =
        load_materials(folder,
                       "<bsdf type='normalmap'><boolean name='flip_invalid_normals' "
                       "value='false'/><boolean name='use_shadowing_function' value='false'/>" +
                           texture_named("normalmap") +
                           "<bsdf type='blendbsdf'><float name='weight' value='0.2'/>" + kRed +
                           kMetal + "</bsdf></bsdf>")
            .scene;
    for (const MaterialId id : {shown(blend).blend->first, shown(blend).blend->second}) {
        ASSERT_TRUE(blend[id].normals);
        EXPECT_FALSE(blend[id].normals->flip_invalid || blend[id].normals->shadowing);
    }
}

TEST(LayeredMaterials, ABumpMapIsANormalMapOfHeights) {
    const TemporaryFolder folder;
    const LoadedScene loaded = load_materials(
        folder, "<bsdf type='bumpmap' id='b'><float name='scale' value='0.25'/>" +
                    texture_named("anything") + "<bsdf type='twosided'>" + kRed + "</bsdf></bsdf>");
    ASSERT_TRUE(shown(loaded.scene).normals);
    const NormalMap& map = *shown(loaded.scene).normals;
    EXPECT_EQ(map.height_scale, 0.25f);
    EXPECT_TRUE(map.flip_invalid && map.shadowing && !map.mirrored);
    EXPECT_TRUE(shown(loaded.scene).has_sides());
    Scene scene = loaded.scene;
    EXPECT_THROW(require_parameter(scene, "b.nested_texture"), InputError);
}

TEST(LayeredMaterials, TwoSidesOfANormalMapMirrorIt) {
    const TemporaryFolder folder;
    for (const char* kind : {"normalmap", "bumpmap"}) {
        const Scene scene =
            load_materials(folder, fmt::format("<bsdf type='twosided'><bsdf type='{}'>", kind) +
                                       texture_named("normalmap") + kRed + "</bsdf></bsdf>")
                .scene;
        ASSERT_TRUE(shown(scene).normals);
        EXPECT_TRUE(shown(scene).normals->mirrored);
        EXPECT_TRUE(shown(scene).back && !shown(scene).has_sides());
    }
}

/// An image of a square from the front and of another one from behind.
Image image_of_both_sides(const TemporaryFolder& folder, const std::string& bsdf) {
    const auto square = [&](const char* placed) {
        return fmt::format(
            "<shape type='rectangle'><transform name='to_world'>{}</transform>{}</shape>", placed,
            bsdf);
    };
    const auto file = write_text(
        folder, "sides.xml",
        "<scene version='3.0.0'><integrator type='direct'/><emitter type='constant'/>"
        "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='16'/>"
        "<integer name='height' value='8'/></film></sensor>" +
            square("<rotate y='1' angle='180'/><translate x='1.1' z='4'/>") +
            square("<translate x='-1.1' z='4'/>") + "</scene>");
    return Renderer::load(file.string()).render(4);
}

TEST(LayeredMaterials, TwosidedInsideTwosidedChangesNothing) {
    const TemporaryFolder folder;
    Image map = make_image(2, 2, 3, 0.6f);
    map.at(1, 0, 0) = 0.8f, map.at(0, 1, 2) = 0.9f;
    write_image(folder.path / "map.exr", map);
    const std::string textured = "<bsdf type='diffuse'>" + texture_named("reflectance") + "</bsdf>";
    const std::string mapped =
        "<bsdf type='normalmap'>" + texture_named("normalmap") + kRed + "</bsdf>";
    for (const std::string& inside : {textured, textured + kMetal, mapped}) {
        const auto within = [](const std::string& bsdfs) {
            return "<bsdf type='twosided'>" + bsdfs + "</bsdf>";
        };
        // As in Mitsuba what is inside is seen from its front alone.
        const Image expected =
            image_of_both_sides(folder, within(inside == mapped ? mapped : textured));
        EXPECT_EQ(image_of_both_sides(folder, within(within(inside))), expected) << inside;
    }
}

TEST(LayeredMaterials, TwosidedInsideTwosidedHasMitsubasNames) {
    const TemporaryFolder folder;
    const Scene scene =
        load_materials(folder, "<bsdf type='twosided' id='m'><bsdf type='twosided'>" + kRed +
                                   "</bsdf>" + kMetal + "</bsdf>")
            .scene;
    EXPECT_EQ(scene.constants[0].name, "m.brdf_0.brdf_0.reflectance.value");
    EXPECT_EQ(shown(scene).id, "m");
    EXPECT_TRUE(shown(scene).has_sides());
    EXPECT_EQ(scene.materials.size(), 1u);
}

TEST(LayeredMaterials, WhatIsWrongIsSaid) {
    const TemporaryFolder folder;
    const auto expect = [&](const std::string& bsdf, const std::string& words) {
        try {
            load_materials(folder, bsdf);
            ADD_FAILURE() << "nothing was said: " << words;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find(":3:"), std::string::npos) << error.what();
        }
    };
    expect("<bsdf type='mask'/>", "bsdf \"mask\" has 0 nested bsdfs, expected 1");
    expect("<bsdf type='mask'><float name='opacity' value='1.5'/>" + kRed + "</bsdf>",
           "\"opacity\" is 1.5, expected a value in [0, 1]");
    expect("<bsdf type='blendbsdf'>" + kRed + kRed + "</bsdf>",
           "bsdf \"blendbsdf\" has no \"weight\", expected one");
    expect("<bsdf type='normalmap'>" + kRed + "</bsdf>",
           "bsdf \"normalmap\" has no texture \"normalmap\", expected one");
    expect("<bsdf type='twosided'><bsdf type='normalmap'>" + texture_named("normalmap") + kRed +
               "</bsdf>" + kRed + "</bsdf>",
           "found a normal map on one of two sides, expected one bsdf for both");
    expect("<bsdf type='twosided'><bsdf type='normalmap'>" + texture_named("normalmap") +
               "<bsdf type='twosided'>" + kRed + "</bsdf></bsdf></bsdf>",
           "found \"twosided\" inside a map inside \"twosided\", expected a one-sided bsdf");
    expect("<bsdf type='twosided'><bsdf type='mask'>" + kRed + "</bsdf></bsdf>",
           "found a bsdf that transmits inside \"twosided\"");
    expect("<bsdf type='normalmap'>" + texture_named("normalmap") + "<bsdf type='normalmap'>" +
               texture_named("normalmap") + kRed + "</bsdf></bsdf>",
           "found a normal or bump map inside another one");
}

/// Blends of `depth` levels, each of which refers to the one below twice.
std::string nested_blends(int depth, const std::string& lowest) {
    std::string text = "<bsdf type='diffuse' id='b0'>" + lowest + "</bsdf>\n";
    for (int i = 1; i <= depth; ++i)
        text += fmt::format(
            "<bsdf type='blendbsdf' id='b{}'><float name='weight' value='0.5'/><ref id='b{}'/><ref "
            "id='b{}'/></bsdf>\n",
            i, i - 1, i - 1);
    return kFrame + "\n" + text;
}

TEST(LayeredMaterials, PartsThatAreSharedManyTimesAreRefused) {
    const TemporaryFolder folder;
    const Scene scene =
        load_text(folder, nested_blends(7, "") + "<shape type='cube'><ref id='b7'/></shape>").scene;
    EXPECT_EQ(scene.bsdfs.size(), 1u);
    try {
        load_text(folder, nested_blends(60, ""));
        ADD_FAILURE() << "nothing was said";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("a bsdf that holds more than 255 others"),
                  std::string::npos)
            << error.what();
    }
    LoadOptions options;
    options.ignore_unsupported = true;
    const LoadedScene loaded = load_text(folder, nested_blends(60, ""), options);
    EXPECT_EQ(loaded.warnings.size(), 6u);  // equal ones of 53 are said once
    EXPECT_TRUE(mentions(loaded.warnings, "a bsdf that holds more than 255 others"));
}

TEST(LayeredMaterials, PartsThatReadMeshAttributesAreVisitedOnce) {
    const TemporaryFolder folder;
    const std::string color =
        "<texture type='mesh_attribute' name='reflectance'><string name='name' "
        "value='vertex_color'/></texture>";
    write_text(folder, "scene.xml",
               "<scene version='3.0.0'>" + nested_blends(60, color) +
                   "<shape type='cube'><ref id='b60'/></shape></scene>");
    EXPECT_NE(error_of(folder.path / "scene.xml").find("the shape has no attribute"),
              std::string::npos);
}

TEST(LayeredMaterials, SharesAreParametersAndNormalsAreNot) {
    const TemporaryFolder folder;
    Scene scene = load_materials(folder, "<bsdf type='normalmap' id='n'>" +
                                             texture_named("normalmap") + "<bsdf type='mask'>" +
                                             texture_named("opacity") + kRed + "</bsdf></bsdf>")
                      .scene;
    ASSERT_EQ(scene.parameters.size(), 1u);
    EXPECT_EQ(scene.parameters[0].name, "n.nested_bsdf.opacity.data");
    EXPECT_EQ(require_parameter(scene, "n.opacity"), 0u);
    const auto expect = [&](Scene& of, const char* name) {
        try {
            require_parameter(of, name);
            ADD_FAILURE() << name;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("says which material or normal is shown"),
                      std::string::npos)
                << error.what();
        }
    };
    expect(scene, "n.normalmap");
    Scene board = load_materials(folder,
                                 "<bsdf type='mask' id='m'><texture type='checkerboard' "
                                 "name='opacity'/>" +
                                     kRed + "</bsdf>")
                      .scene;
    expect(board, "m.opacity");
}

TEST(LayeredMaterials, AConstantShareBecomesATexture) {
    const TemporaryFolder folder;
    const auto load = [&] {
        return load_materials(folder,
                              "<bsdf type='twosided' id='t'><bsdf type='blendbsdf'><float "
                              "name='weight' value='0.2'/>" +
                                  kRed + kMetal + "</bsdf></bsdf>")
            .scene;
    };
    Scene one = load(), many = load();
    const Parameter& value = one.parameters[require_parameter(one, "t.weight")];
    EXPECT_EQ(value.name, "t.brdf_0.weight.value");
    EXPECT_EQ(shown(one).blend->weight.texture, value.texture);
    EXPECT_EQ(std::get<Bitmap>(one[value.texture]).values, std::vector<float>{0.2f});
    EXPECT_EQ(many.parameters[require_parameter(many, "t.weight:8")].name, "t.brdf_0.weight.data");
    EXPECT_EQ(std::get<Bitmap>(many.textures[0]).width, 8);
}

TEST(LayeredMaterials, PartsOfBlendsGetTheirOwnBsdfs) {
    const TemporaryFolder folder;
    write_image(folder.path / "map.exr", make_image(2, 2, 3, 0.5f));
    const std::string red = kRed.substr(0, 6) + "id='red' " + kRed.substr(6);
    const std::string ref = "<ref id='red'/>";
    Scene scene = load_text(folder, kFrame + red + "<shape type='rectangle'>" + ref +
                                        "</shape><shape type='rectangle'><bsdf type='blendbsdf'>" +
                                        texture_named("weight") + ref + "<bsdf type='twosided'>" +
                                        ref + "</bsdf></bsdf></shape>")
                      .scene;
    EXPECT_EQ(scene.bsdfs.size(), 1u);
    separate_parts(scene);
    EXPECT_EQ(scene.bsdfs.size(), 3u);
    const MaterialBlend& blend = *scene[scene.shapes[1].material].blend;
    const BsdfId alone = shown(scene).front, first = scene[blend.first].front,
                 second = scene[blend.second].front;
    EXPECT_EQ(alone, BsdfId{0});
    EXPECT_EQ(scene[blend.second].back, second);
    EXPECT_TRUE(shares_of(scene, alone).empty());
    const TextureId weight = blend.weight.texture;
    ASSERT_EQ(shares_of(scene, first).size(), 1u);
    EXPECT_EQ(shares_of(scene, first)[0], (BlendShare{weight, false}));
    ASSERT_EQ(shares_of(scene, second).size(), 1u);
    EXPECT_EQ(shares_of(scene, second)[0], (BlendShare{weight, true}));
    const auto before = scene.shares;
    separate_parts(scene);
    EXPECT_EQ(scene.shares, before);
}

}  // namespace
}  // namespace burnish
