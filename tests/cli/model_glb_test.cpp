// Scenes as binary glTF: its rules, what materials and textures turn into, and where things are.
#include "models/model_glb.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>

#include "glb_rules.h"
#include "image/files.h"
#include "image/image.h"
#include "mitsuba/load.h"
#include "program.h"
#include "shading/principled.h"
#include "temporary_folder.h"

namespace burnish {

namespace {

namespace fs = std::filesystem;
using testing::check_glb;
using testing::GlbContent;
using Json = nlohmann::json;
using enum PrincipledScalar;

Bitmap bitmap_of_texels(const Image& texels) {
    Bitmap bitmap;
    replace_texels(bitmap, texels);
    return bitmap;
}

/// A triangle of one material, whose coordinates are easy to follow.
Scene scene_of(const Bsdf& bsdf) {
    Scene scene;
    scene.bsdfs.push_back(bsdf);
    scene.materials.push_back({"mat", BsdfId{0}, {}});
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {2, 0, 0}, {0, 3, 1}};
    mesh.normals = {{0, 0, 1}, {0, 0, 2}, {0, 0, 0}};
    mesh.uvs = {{0, 0}, {1, 0.25f}, {0.5f, 1}};
    mesh.triangles = {{{0, 1, 2}}};
    scene.shapes.push_back({"thing", mesh, MaterialId{0}, {}});
    return scene;
}

TextureId add(Scene& scene, const Texture& texture) {
    scene.textures.push_back(texture);
    return {static_cast<std::int32_t>(scene.textures.size()) - 1};
}

GlbContent glb_of(const Scene& scene) { return check_glb(model_glb(scene, {scene.textures, {}})); }

Principled& principled_of(Scene& scene) { return std::get<Principled>(scene.bsdfs[0]); }

const Json& material_of(const GlbContent& glb, std::size_t mesh = 0) {
    const Json& primitive = glb.json["meshes"][mesh]["primitives"][0];
    return glb.json["materials"][primitive["material"].get<std::size_t>()];
}

/// A PNG of the model as its codes, 0 to 1.
Image codes_of(const GlbContent& glb, const Json& texture_info) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path / "codes.png";
    write_bytes(file, testing::png_of(glb, texture_info));
    return read_image_file(file).image;
}

TEST(ModelGlb, AMeshStaysWhereItIsAndItsCoordinatesToo) {
    const GlbContent glb = glb_of(scene_of(Diffuse{}));
    const Json& attributes = glb.json["meshes"][0]["primitives"][0]["attributes"];
    EXPECT_EQ(testing::floats_of(glb, attributes["POSITION"]),
              (std::vector<float>{0, 0, 0, 2, 0, 0, 0, 3, 1}));
    // Row 0 of a picture is v = 0 in both.
    EXPECT_EQ(testing::floats_of(glb, attributes["TEXCOORD_0"]),
              (std::vector<float>{0, 0, 1, 0.25f, 0.5f, 1}));
    EXPECT_EQ(glb.json["nodes"][0]["name"], "thing");
}

TEST(ModelGlb, ConstantsAreFactors) {
    Scene scene = scene_of(Principled{});
    Principled& p = principled_of(scene);
    p.base_color.constant = {0.1f, 0.2f, 0.3f};
    p[kRoughness].constant = 0.25f;
    p[kMetallic].constant = 0.75f;
    p.eta = 1.25f;
    scene.materials[0].back = BsdfId{0};
    const GlbContent glb = glb_of(scene);
    const Json& material = material_of(glb);
    const Json& pbr = material["pbrMetallicRoughness"];
    EXPECT_EQ(pbr["baseColorFactor"][2].get<float>(), 0.3f);
    EXPECT_EQ(pbr["roughnessFactor"].get<float>(), 0.25f);
    EXPECT_EQ(pbr["metallicFactor"].get<float>(), 0.75f);
    EXPECT_EQ(material["extensions"]["KHR_materials_ior"]["ior"].get<float>(), 1.25f);
    EXPECT_TRUE(material["doubleSided"].get<bool>());
    EXPECT_FALSE(glb.json.contains("textures"));
}

/// Interfaces have the nearest material that glTF has: its roughness is the root of alpha.
TEST(ModelGlb, InterfacesAreMetalsPlasticsAndGlass) {
    struct Expected {
        Bsdf bsdf;
        float metallic, roughness;
        bool transmits;
    };
    FacetRoughness rough;
    rough.alpha[0].constant = 0.25f;
    RoughConductor metal;
    metal.roughness = rough;
    RoughPlastic plastic;
    plastic.alpha = 0.25f;
    const std::array<ColorInput, 2> white{kWhite, kWhite};
    for (const Expected& e : {Expected{Conductor{}, 1, 0, false}, Expected{metal, 1, 0.5f, false},
                              Expected{Plastic{}, 0, 0, false}, Expected{plastic, 0, 0.5f, false},
                              Expected{Dielectric{white, 0.8f, false}, 0, 0, true},
                              Expected{Dielectric{white, 1.5f, true}, 0, 0, true},
                              Expected{RoughDielectric{white, 1.5f, rough}, 0, 0.5f, true},
                              Expected{PrincipledThin{}, 0, 0.5f, true}}) {
        const GlbContent glb = glb_of(scene_of(e.bsdf));
        const Json& material = material_of(glb);
        const Json& pbr = material["pbrMetallicRoughness"];
        EXPECT_EQ(pbr["metallicFactor"].get<float>(), e.metallic) << e.bsdf.index();
        EXPECT_EQ(pbr["roughnessFactor"].get<float>(), e.roughness) << e.bsdf.index();
        const bool transmits = material.contains("extensions") &&
                               material["extensions"].contains("KHR_materials_transmission");
        EXPECT_EQ(transmits, e.transmits) << e.bsdf.index();
        const bool has_volume = material.contains("extensions") &&
                                material["extensions"].contains("KHR_materials_volume");
        EXPECT_EQ(has_volume, e.transmits && !is_sheet(e.bsdf)) << e.bsdf.index();
        const Json used = glb.json.value("extensionsUsed", Json::array());
        EXPECT_EQ(std::count(used.begin(), used.end(), "KHR_materials_volume"), has_volume ? 1 : 0)
            << e.bsdf.index();
        if (has_volume) {
            EXPECT_GT(
                material["extensions"]["KHR_materials_volume"]["thicknessFactor"].get<float>(), 0);
        }
        if (e.metallic == 0) {
            EXPECT_GE(material["extensions"]["KHR_materials_ior"]["ior"].get<float>(), 1)
                << e.bsdf.index();
        }
    }
    Conductor gold;
    gold.index = {{0.1430f, 0.3753f, 1.4420f}, {3.983f, 2.3856f, 1.6032f}};
    const GlbContent glb = glb_of(scene_of(gold));
    const Json& color = material_of(glb)["pbrMetallicRoughness"]["baseColorFactor"];
    EXPECT_NEAR(color[0].get<float>(), 0.966, 0.01) << "its reflectance at normal incidence";
    EXPECT_NEAR(color[2].get<float>(), 0.322, 0.03);
}

TEST(ModelGlb, ATextureOfOneTexelIsAConstant) {
    Scene scene = scene_of(Principled{});
    principled_of(scene)[kMetallic].texture =
        add(scene, bitmap_of_texels(make_image(1, 1, 1, 0.25f)));
    principled_of(scene).base_color.texture =
        add(scene, bitmap_of_texels({1, 1, 3, {0.125f, 0.5f, 1}}));
    const GlbContent glb = glb_of(scene);
    const Json& pbr = material_of(glb)["pbrMetallicRoughness"];
    EXPECT_EQ(pbr["metallicFactor"], 0.25);
    EXPECT_EQ(pbr["baseColorFactor"], (Json{0.125, 0.5, 1.0, 1}));
    EXPECT_FALSE(glb.json.contains("textures"));
}

TEST(ModelGlb, RoughnessIsInGreenAndMetallicInBlue) {
    Scene scene = scene_of(Principled{});
    Image roughness = make_image(4, 2, 1), metallic = make_image(2, 2, 1);
    for (std::size_t i = 0; i < 8; ++i) roughness.values[i] = static_cast<float>(i) / 255;
    for (std::size_t i = 0; i < 4; ++i) metallic.values[i] = static_cast<float>(i) / 5;
    Bitmap coarse = bitmap_of_texels(metallic);
    coarse.filter = TextureFilter::kNearest;
    principled_of(scene)[kRoughness].texture = add(scene, bitmap_of_texels(roughness));
    principled_of(scene)[kMetallic].texture = add(scene, coarse);
    const GlbContent glb = glb_of(scene);
    const Json& pbr = material_of(glb)["pbrMetallicRoughness"];
    const Image codes = codes_of(glb, pbr["metallicRoughnessTexture"]);
    ASSERT_EQ(codes.width, 4);
    ASSERT_EQ(codes.height, 2);
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 4; ++x) {
            EXPECT_EQ(codes.at(x, y, 0), 1);
            EXPECT_EQ(codes.at(x, y, 1), roughness.at(x, y, 0));
            EXPECT_EQ(codes.at(x, y, 2), metallic.at(x / 2, y, 0));
        }
    EXPECT_EQ(pbr["roughnessFactor"], 1);
    EXPECT_EQ(pbr["metallicFactor"], 1);
}

TEST(ModelGlb, ATextureOfAlphaIsItsRootAlsoWhereOtherTexelsTakeItsPlace) {
    RoughConductor metal;
    Scene scene = scene_of(metal);
    auto& alpha = std::get<RoughConductor>(scene.bsdfs[0]).roughness.alpha;
    alpha[0].texture = alpha[1].texture =
        add(scene, bitmap_of_texels({2, 2, 1, {0.04f, 0.04f, 0.04f, 0.04f}}));
    const std::vector<float> recovered{0, 0.04f, 0.36f, 1};
    const GlbContent glb = check_glb(model_glb(scene, {scene.textures, {recovered.data()}}));
    const Json& pbr = material_of(glb)["pbrMetallicRoughness"];
    const Image codes = codes_of(glb, pbr["metallicRoughnessTexture"]);
    EXPECT_EQ(pbr["roughnessFactor"], 1);
    EXPECT_EQ(pbr["metallicFactor"], 1);
    for (std::size_t i = 0; i < recovered.size(); ++i) {
        EXPECT_NEAR(codes.values[3 * i + 1], std::sqrt(recovered[i]), 0.5 / 255) << i;
        EXPECT_EQ(codes.values[3 * i + 2], 1) << i;
    }
}

TEST(ModelGlb, ColoursAreSrgbAndOneTextureOfTwoMaterialsIsKeptOnce) {
    Scene scene = scene_of(Principled{});
    Image color = make_image(2, 2, 3, 0.5f);
    color.at(0, 1, 2) = 0.1f;
    principled_of(scene).base_color.texture = add(scene, bitmap_of_texels(color));
    scene.bsdfs.push_back(scene.bsdfs[0]);
    scene.materials.push_back({"other", BsdfId{1}, {}});
    scene.shapes.push_back(scene.shapes[0]);
    scene.shapes[1].material = MaterialId{1};
    const GlbContent glb = glb_of(scene);
    const Image codes = codes_of(glb, material_of(glb)["pbrMetallicRoughness"]["baseColorTexture"]);
    for (std::size_t i = 0; i < color.values.size(); ++i)
        EXPECT_NEAR(codes.values[i], linear_to_srgb(color.values[i]), 0.5 / 255 + 1e-6);
    EXPECT_EQ(glb.json["materials"].size(), 2u);
    EXPECT_EQ(glb.json["images"].size(), 1u);
}

TEST(ModelGlb, TransformedCoordinatesAreASetOfTheirOwn) {
    Scene scene = scene_of(Principled{});
    Bitmap stretched = bitmap_of_texels(make_image(4, 4, 1, 0.5f));
    for (int i = 0; i < 16; ++i)
        stretched.values[static_cast<std::size_t>(i)] = static_cast<float>(i) / 15;
    stretched.to_uv.m = {3, 0, 0.5f, 0, 2, 0};
    stretched.wrap = TextureWrap::kMirror;
    principled_of(scene)[kRoughness].texture = add(scene, stretched);
    principled_of(scene).base_color.texture = add(scene, bitmap_of_texels(make_image(2, 2, 3)));
    const GlbContent glb = glb_of(scene);
    const Json& info = material_of(glb)["pbrMetallicRoughness"]["metallicRoughnessTexture"];
    const auto set = "TEXCOORD_" + std::to_string(info["texCoord"].get<int>());
    const Json& attributes = glb.json["meshes"][0]["primitives"][0]["attributes"];
    EXPECT_EQ(attributes.size(), 4u);  // position, normal, two of coordinates
    EXPECT_EQ(testing::floats_of(glb, attributes[set]),
              (std::vector<float>{0.5f, 0, 3.5f, 0.5f, 2, 2}));
    const Image codes = codes_of(glb, info);
    for (std::size_t i = 0; i < 16; ++i)
        EXPECT_NEAR(codes.values[3 * i + 1], stretched.values[i], 0.5 / 255 + 1e-6) << i;
    const auto texture = info["index"].get<std::size_t>();
    const auto sampler = glb.json["textures"][texture]["sampler"].get<std::size_t>();
    EXPECT_EQ(glb.json["samplers"][sampler]["wrapS"], 33648);
}

TEST(ModelGlb, TheFirstCoordinatesAreThoseOfTheMesh) {
    Scene scene = scene_of(Principled{});
    Bitmap turned = bitmap_of_texels(make_image(2, 2, 3, 0.5f));
    turned.to_uv.m = {0, -1, 1, 1, 0, 0};
    principled_of(scene).base_color.texture = add(scene, turned);
    const GlbContent glb = glb_of(scene);
    EXPECT_EQ(material_of(glb)["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"], 1);
    const Json& attributes = glb.json["meshes"][0]["primitives"][0]["attributes"];
    EXPECT_EQ(testing::floats_of(glb, attributes["TEXCOORD_0"]),
              (std::vector<float>{0, 0, 1, 0.25f, 0.5f, 1}));
    EXPECT_EQ(testing::floats_of(glb, attributes["TEXCOORD_1"]),
              (std::vector<float>{1, 0, 0.75f, 1, 0, 0.5f}));
}

/// A bitmap of 8-bit codes that grow along x and y, read nearest.
Bitmap ramp(int width, int height, const UvTransform& to_uv = {}) {
    Image texels = make_image(width, height, 1);
    for (std::size_t i = 0; i < texels.values.size(); ++i)
        texels.values[i] = static_cast<float>(3 * i + 1) / 255;
    Bitmap bitmap = bitmap_of_texels(texels);
    bitmap.filter = TextureFilter::kNearest;
    bitmap.to_uv = to_uv;
    return bitmap;
}

TEST(ModelGlb, APictureOfTwoTexturesHoldsTheOneThatRepeatsLeastOftenWhole) {
    Scene scene = scene_of(Principled{});
    const Bitmap often = ramp(4, 2, {{4, 0, 0, 0, 3, 0}}), once = ramp(2, 8);
    principled_of(scene)[kRoughness].texture = add(scene, often);
    principled_of(scene)[kMetallic].texture = add(scene, once);
    const GlbContent glb = glb_of(scene);
    const Json& info = material_of(glb)["pbrMetallicRoughness"]["metallicRoughnessTexture"];
    const Json& attributes = glb.json["meshes"][0]["primitives"][0]["attributes"];
    const auto set = "TEXCOORD_" + std::to_string(info["texCoord"].get<int>());
    EXPECT_EQ(testing::floats_of(glb, attributes[set]),
              (std::vector<float>{0, 0, 1, 0.25f, 0.5f, 1}));
    const Image codes = codes_of(glb, info);
    ASSERT_EQ(codes.width, 16);
    ASSERT_EQ(codes.height, 8);
    const Image rough = linear_image(often), metal = linear_image(once);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 16; ++x) {
            EXPECT_EQ(codes.at(x, y, 1), rough.at(x % 4, (6 * y + 3) / 8 % 2, 0)) << x << ' ' << y;
            EXPECT_EQ(codes.at(x, y, 2), metal.at(x / 8, y, 0)) << x << ' ' << y;
        }
}

TEST(ModelGlb, ATextureThatShowsALineOfItselfIsThatLine) {
    Scene scene = scene_of(Principled{});
    const Bitmap line = ramp(2, 4, {{0, 0, 0.25f, 0, 2, 0}});
    principled_of(scene)[kRoughness].texture = add(scene, line);
    const GlbContent glb = glb_of(scene);
    const Image codes =
        codes_of(glb, material_of(glb)["pbrMetallicRoughness"]["metallicRoughnessTexture"]);
    const Image texels = linear_image(line);
    ASSERT_EQ(codes.height, 4);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 2; ++x) EXPECT_EQ(codes.at(x, y, 1), texels.at(0, y, 0)) << y;
}

TEST(ModelGlb, APictureOfHuesHasAFactorAboveOne) {
    Scene scene = scene_of(Principled{});
    Principled& p = principled_of(scene);
    p.has_spec_tint = true;
    p[kSpecTint].constant = 1;
    const std::array<Rgbf, 2> colors{Rgbf{0.1f, 0.2f, 0.8f}, Rgbf{0.5f, 0.5f, 0.5f}};
    p.base_color.texture =
        add(scene, bitmap_of_texels({2, 1, 3, {0.1f, 0.2f, 0.8f, 0.5f, 0.5f, 0.5f}}));
    const GlbContent glb = glb_of(scene);
    const Json& specular = material_of(glb)["extensions"]["KHR_materials_specular"];
    const Image codes = codes_of(glb, specular["specularColorTexture"]);
    for (int x = 0; x < 2; ++x) {
        const Rgbf hue = principled_tint(colors[static_cast<std::size_t>(x)]);
        for (int c = 0; c < 3; ++c) {
            const float factor =
                specular["specularColorFactor"][static_cast<std::size_t>(c)].get<float>();
            EXPECT_NEAR(factor * srgb_to_linear(codes.at(x, 0, c)), hue[c], 0.01 * factor) << x;
        }
    }
    EXPECT_GT(principled_tint(colors[0]).z, 2);
}

TEST(ModelGlb, SheetsAreSeenFromBothSides) {
    const std::array<ColorInput, 2> white{kWhite, kWhite};
    for (const auto& [bsdf, both] :
         std::initializer_list<std::pair<Bsdf, bool>>{{PrincipledThin{}, true},
                                                      {Dielectric{white, 1.5f, true}, true},
                                                      {Dielectric{white, 1.5f, false}, false},
                                                      {Diffuse{}, false}})
        EXPECT_EQ(material_of(glb_of(scene_of(bsdf))).contains("doubleSided"), both)
            << bsdf.index();
}

TEST(ModelGlb, LobesBecomeExtensions) {
    Scene scene = scene_of(Principled{});
    Principled& p = principled_of(scene);
    p.has_clearcoat = p.has_sheen = p.has_anisotropic = p.has_spec_tint = p.has_spec_trans = true;
    p.base_color.constant = {0.2f, 0.2f, 0.2f};
    p[kClearcoat].constant = 0.8f;
    p[kClearcoatGloss].constant = 1;
    p[kSheen].constant = 0.5f;
    p[kMetallic].constant = 0.5f;
    p[kSpecTrans].constant = 0.125f;
    Image anisotropic = make_image(2, 2, 1, 1);
    anisotropic.values[3] = 0;
    p[kAnisotropic].texture = add(scene, bitmap_of_texels(anisotropic));
    const GlbContent glb = glb_of(scene);
    const Json& extensions = material_of(glb)["extensions"];
    const Json& coat = extensions["KHR_materials_clearcoat"];
    EXPECT_NEAR(coat["clearcoatFactor"].get<float>(), 0.2f, 1e-6f);
    EXPECT_NEAR(coat["clearcoatRoughnessFactor"].get<float>(), std::sqrt(0.001f), 1e-5f);
    EXPECT_EQ(extensions["KHR_materials_sheen"]["sheenColorFactor"][1].get<float>(), 0.25f);
    EXPECT_EQ(extensions["KHR_materials_transmission"]["transmissionFactor"].get<float>(), 0.125f);
    EXPECT_EQ(extensions["KHR_materials_specular"]["specularColorFactor"][0].get<float>(), 1);
    const Json& brushed = extensions["KHR_materials_anisotropy"];
    EXPECT_EQ(brushed["anisotropyStrength"], 1);
    const Image codes = codes_of(glb, brushed["anisotropyTexture"]);
    EXPECT_EQ(codes.at(0, 0, 0), 1);
    EXPECT_NEAR(codes.at(0, 0, 1), 0.5f, 1.0f / 255);
    EXPECT_EQ(codes.at(0, 0, 2), 1);
    EXPECT_EQ(codes.at(1, 1, 2), 0);
}

TEST(ModelGlb, AConstantAnisotropyHasATextureOfItsDirection) {
    Scene scene = scene_of(Principled{});
    principled_of(scene).has_anisotropic = true;
    for (const float strength : {0.0f, 0.75f}) {
        principled_of(scene)[kAnisotropic].constant = strength;
        const GlbContent glb = glb_of(scene);
        const Json& brushed = material_of(glb)["extensions"]["KHR_materials_anisotropy"];
        EXPECT_EQ(brushed["anisotropyStrength"].get<float>(), strength);
        ASSERT_EQ(brushed.contains("anisotropyTexture"), strength > 0);
        if (strength == 0) continue;
        const Json& info = brushed["anisotropyTexture"];
        EXPECT_EQ(info["texCoord"], 0);
        const Image codes = codes_of(glb, info);
        ASSERT_EQ(codes.values.size(), 3u);
        EXPECT_EQ(codes.values[0], 1);
        EXPECT_NEAR(codes.values[1], 0.5f, 1.0f / 255);
        EXPECT_EQ(codes.values[2], 1);
    }
}

TEST(ModelGlb, LightsAndCamerasComeAlong) {
    Scene scene = scene_of(Diffuse{});
    scene.emitters.push_back(AreaEmitter{{2, 8, 4}, ShapeId{0}});
    scene.shapes[0].emitter = EmitterId{0};
    SceneSensor sensor{"front", {}, {}};
    sensor.camera.to_world = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0});
    sensor.camera.fov_x = 90;
    sensor.film.width = 200, sensor.film.height = 100;
    scene.sensors.push_back(sensor);
    const GlbContent glb = glb_of(scene);
    const Json& material = material_of(glb);
    EXPECT_EQ(material["emissiveFactor"], (Json{0.25, 1.0, 0.5}));
    EXPECT_EQ(material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"], 8);
    EXPECT_NEAR(glb.json["cameras"][0]["perspective"]["yfov"].get<double>(), 2 * std::atan(0.5),
                1e-12);
    const Json& m = glb.json["nodes"][1]["matrix"];
    const std::array<double, 16> expected{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1};
    for (std::size_t i = 0; i < 16; ++i) EXPECT_NEAR(m[i].get<double>(), expected[i], 1e-12) << i;
}

TEST(ModelGlb, SpheresAndDisksFaceOutwardsWithTheirCoordinates) {
    Scene scene = scene_of(Diffuse{});
    scene.shapes[0].geometry = Sphere{{1, 2, 3}, 2, {}, false};
    const Transform turned = translation({0, 1, 0}) * scaling({-1, 2, 1});
    scene.shapes.push_back({"disk", Disk{turned, inverse(turned), false}, MaterialId{0}, {}});
    const GlbContent glb = glb_of(scene);
    for (std::size_t k = 0; k < 2; ++k) {
        const Json& primitive = glb.json["meshes"][k]["primitives"][0];
        const auto positions = testing::floats_of(glb, primitive["attributes"]["POSITION"]);
        const auto normals = testing::floats_of(glb, primitive["attributes"]["NORMAL"]);
        const auto at = [](const std::vector<float>& v, std::uint32_t i) {
            return Vec3f{v[3 * i], v[3 * i + 1], v[3 * i + 2]};
        };
        const auto indices = testing::indices_of(glb, primitive["indices"]);
        for (std::size_t i = 0; i < indices.size(); i += 3) {
            const Vec3f a = at(positions, indices[i]);
            const Vec3f n =
                cross(at(positions, indices[i + 1]) - a, at(positions, indices[i + 2]) - a);
            EXPECT_GT(dot(n, at(normals, indices[i])), 0);
        }
    }
    // u = 1/4, v = 1/2 of the sphere: its +y.
    const Json& attributes = glb.json["meshes"][0]["primitives"][0]["attributes"];
    const auto uvs = testing::floats_of(glb, attributes["TEXCOORD_0"]);
    const auto positions = testing::floats_of(glb, attributes["POSITION"]);
    bool found = false;
    for (std::size_t i = 0; 2 * i < uvs.size(); ++i)
        if (uvs[2 * i] == 0.25f && uvs[2 * i + 1] == 0.5f) {
            found = true;
            EXPECT_NEAR(positions[3 * i], 1, 1e-5);
            EXPECT_NEAR(positions[3 * i + 1], 4, 1e-5);
            EXPECT_NEAR(positions[3 * i + 2], 3, 1e-5);
        }
    EXPECT_TRUE(found);
}

using Deliverables = testing::Program;

/// What import_into_blender.py makes materials of.
Json materials_of(const std::string& script) {
    const std::string before = "\nMATERIALS = ";
    const std::size_t from = script.find(before) + before.size();
    return Json::parse(script.substr(from, script.find("\n\n\ndef folder") - from));
}

TEST_F(Deliverables, TheSceneRendersTheResultToTheByte) {
    write_scene();
    const testing::Outcome done =
        run("optimize scene.xml -D light=3 --parameter mat-panel.roughness "
            "--parameter mat-panel.base_color --iterations 3 --target-spp 4 --evaluation-spp 4 "
            "-o out");
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(done.err.find("left out"), std::string::npos) << done.err;
    const std::string textures =
        "--texture mat-panel.roughness=out/textures/mat-panel.brdf_0.roughness.data.exr "
        "--texture mat-panel.base_color=out/textures/mat-panel.brdf_0.base_color.data.exr ";
    ASSERT_EQ(run("render scene.xml -D light=3 --spp 8 --seed 7 -o a.exr " + textures).code, 0);
    ASSERT_EQ(run("render out/scene/scene.xml --spp 8 --seed 7 -o b.exr").code, 0);
    ASSERT_EQ(run("render scene.xml -D light=3 --spp 8 --seed 7 -o c.exr").code, 0);
    EXPECT_EQ(testing::read_text(folder / "a.exr"), testing::read_text(folder / "b.exr"));
    EXPECT_NE(testing::read_text(folder / "a.exr"), testing::read_text(folder / "c.exr"));

    const GlbContent glb = check_glb(testing::read_text(folder / "out/model.glb"));
    EXPECT_EQ(glb.json["meshes"].size(), 2u);
    const Json& pbr = material_of(glb)["pbrMetallicRoughness"];
    const Image codes = codes_of(glb, pbr["metallicRoughnessTexture"]);
    const Image roughness = read_image(folder / "out/textures/mat-panel.brdf_0.roughness.data.exr");
    for (std::size_t i = 0; i < roughness.values.size(); ++i)
        EXPECT_NEAR(codes.values[3 * i + 1], roughness.values[i], 0.5 / 255 + 1e-6);
}

TEST_F(Deliverables, ConstantsAreInAllOfThem) {
    write_scene();
    const testing::Outcome done =
        run("optimize scene.xml --parameter mat-panel.metallic --parameter mat-panel.clearcoat:4x2 "
            "--iterations 3 --target-spp 4 --evaluation-spp 4 -o out");
    ASSERT_EQ(done.code, 0) << done.err;
    const fs::path textures = folder / "out/textures";
    const float metallic =
        read_image(textures / "mat-panel.brdf_0.metallic.value.exr").values.at(0);
    const Image clearcoat = read_image(textures / "mat-panel.brdf_0.clearcoat.data.exr");
    const LoadedScene after = load_scene(folder / "out/scene/scene.xml");
    const auto& bsdf = std::get<Principled>(after.scene.bsdfs[0]);
    EXPECT_EQ(bsdf[kMetallic].constant, metallic);
    EXPECT_FALSE(bsdf[kMetallic].texture);
    ASSERT_TRUE(bsdf[kClearcoat].texture);
    EXPECT_EQ(linear_image(std::get<Bitmap>(after.scene[bsdf[kClearcoat].texture])), clearcoat);
    const GlbContent glb = check_glb(testing::read_text(folder / "out/model.glb"));
    EXPECT_EQ(material_of(glb)["pbrMetallicRoughness"]["metallicFactor"].get<float>(), metallic);
    const Json& coat = material_of(glb)["extensions"]["KHR_materials_clearcoat"];
    EXPECT_EQ(codes_of(glb, coat["clearcoatTexture"]).width, 4);
    const std::string script = testing::read_text(folder / "out/import_into_blender.py");
    EXPECT_TRUE(testing::contains(script, "\"Metallic\": 0.")) << script;
    EXPECT_TRUE(testing::contains(script, "mat-panel.brdf_0.clearcoat.data.exr"));
}

TEST_F(Deliverables, TheScriptHasMaterialsWhoseRecoveredInputsBlenderLacks) {
    write_scene();
    const testing::Outcome done =
        run("optimize scene.xml --parameter mat-panel.spec_tint --iterations 1 --target-spp 1 "
            "--evaluation-spp 1 -o out");
    ASSERT_EQ(done.code, 0) << done.err;
    const std::string script = testing::read_text(folder / "out/import_into_blender.py");
    EXPECT_TRUE(testing::contains(script, "\"mat-panel\": {")) << script;
    EXPECT_TRUE(testing::contains(script, "scene/color.exr")) << script;
}

TEST_F(Deliverables, TheSheenOfTheScriptIsOfThePartThatIsNoMetal) {
    write_scene();
    std::string scene = testing::read_text(folder / "scene.xml");
    const std::string before = "<bsdf type=\"principled\">";
    scene.insert(scene.find(before) + before.size(),
                 "<float name=\"metallic\" value=\"0.25\"/><float name=\"sheen\" value=\"0.8\"/>");
    testing::write_text(folder / "scene.xml", scene);
    for (const auto& [parameter, sheen] :
         {std::pair{"mat-panel.roughness", "\"Sheen Weight\": 0.6"},
          std::pair{"mat-panel.sheen:4x2", "\"scale\": 0.75"}}) {
        const testing::Outcome done =
            run(std::string("optimize scene.xml --parameter ") + parameter +
                " --iterations 1 --target-spp 1 --evaluation-spp 1 -o out");
        ASSERT_EQ(done.code, 0) << done.err;
        const std::string script = testing::read_text(folder / "out/import_into_blender.py");
        EXPECT_TRUE(testing::contains(script, sheen)) << script;
    }
}

/// 0.1 - 0.099 of a gloss above 1.01 is negative, and has no root.
TEST_F(Deliverables, ValuesOfTheScriptAreClamped) {
    write_scene();
    std::string scene = testing::read_text(folder / "scene.xml");
    const std::string before = "<bsdf type=\"principled\">";
    scene.insert(scene.find(before) + before.size(),
                 "<float name=\"metallic\" value=\"-0.2\"/><float name=\"sheen\" value=\"3\"/>"
                 "<float name=\"clearcoat\" value=\"1\"/>"
                 "<float name=\"clearcoat_gloss\" value=\"1.05\"/>");
    testing::write_text(folder / "scene.xml", scene);
    const testing::Outcome done =
        run("optimize scene.xml --parameter mat-panel.roughness --iterations 1 --target-spp 1 "
            "--evaluation-spp 1 -o out");
    ASSERT_EQ(done.code, 0) << done.err;
    const Json inputs =
        materials_of(testing::read_text(folder / "out/import_into_blender.py"))["mat-panel"];
    ASSERT_TRUE(inputs["Coat Roughness"].is_number()) << inputs;
    EXPECT_NEAR(inputs["Coat Roughness"].get<double>(), std::sqrt(0.001), 1e-6);
    EXPECT_EQ(inputs["Metallic"], 0.0);
    EXPECT_EQ(inputs["Sheen Weight"], 1.0);
}

TEST_F(Deliverables, AMetalOfTheScriptHasItsColour) {
    write_scene();
    const std::string before = testing::read_text(folder / "scene.xml");
    const std::size_t from = before.find("<bsdf type=\"principled\">"),
                      end = before.find("</bsdf>", from);
    const std::string metal =
        "<bsdf type=\"roughconductor\"><string name=\"material\" value=\"Au\"/><texture "
        "type=\"bitmap\" name=\"alpha\"><string name=\"filename\" value=\"roughness.exr\"/>"
        "<boolean name=\"raw\" value=\"true\"/></texture>";
    const std::string texture =
        "<texture type=\"bitmap\" name=\"specular_reflectance\"><string name=\"filename\" "
        "value=\"color.exr\"/></texture>";
    for (const bool textured : {false, true}) {
        std::string scene = before;
        scene.replace(from, end - from, textured ? metal + texture : metal);
        testing::write_text(folder / "scene.xml", scene);
        const testing::Outcome done =
            run("optimize scene.xml --parameter mat-panel.alpha --iterations 1 --target-spp 1 "
                "--evaluation-spp 1 -o out");
        ASSERT_EQ(done.code, 0) << done.err;
        const Json base = materials_of(
            testing::read_text(folder / "out/import_into_blender.py"))["mat-panel"]["Base Color"];
        const Json color = textured ? base["times"] : base;
        EXPECT_NEAR(color[0].get<double>(), 0.967, 1e-3) << base;
        EXPECT_NEAR(color[1].get<double>(), 0.802, 1e-3) << base;
        EXPECT_NEAR(color[2].get<double>(), 0.324, 1e-3) << base;
    }
}

TEST_F(Deliverables, NamesBeyondTheBasicPlaneStandInTheScriptAsTheyAre) {
    write_scene();
    const std::string id = "gold\xF0\x9F\x99\x82";
    std::string scene = testing::read_text(folder / "scene.xml");
    for (std::size_t at = scene.find("mat-panel"); at != std::string::npos;
         at = scene.find("mat-panel"))
        scene.replace(at, 9, id);
    testing::write_text(folder / "scene.xml", scene);
    const testing::Outcome done = run("optimize scene.xml --parameter '" + id +
                                      ".roughness' --iterations 1 --target-spp 1 "
                                      "--evaluation-spp 1 -o out");
    ASSERT_EQ(done.code, 0) << done.err;
    const std::string script = testing::read_text(folder / "out/import_into_blender.py");
    EXPECT_TRUE(testing::contains(script, "\"" + id + "\": {")) << script;
}

TEST_F(Deliverables, TheScriptKnowsLinearFilesByTheirExtensionHoweverItIsWritten) {
    write_scene();
    std::string scene = testing::read_text(folder / "scene.xml");
    scene.replace(scene.find("color.exr"), 9, "color.EXR");
    fs::rename(folder / "color.exr", folder / "color.EXR");
    testing::write_text(folder / "scene.xml", scene);
    const testing::Outcome done =
        run("optimize scene.xml --parameter mat-panel.roughness --iterations 1 --target-spp 1 "
            "--evaluation-spp 1 -o out");
    ASSERT_EQ(done.code, 0) << done.err;
    const std::string script = testing::read_text(folder / "out/import_into_blender.py");
    EXPECT_TRUE(testing::contains(script, "color.EXR")) << script;
    EXPECT_TRUE(testing::contains(script, "Linear Rec.709")) << script;
    EXPECT_FALSE(testing::contains(script, "\"sRGB\"")) << script;
}

TEST_F(Deliverables, TheSummaryNamesThemAndASecondRunReplacesThem) {
    write_scene();
    const std::string command =
        "optimize scene.xml --parameter mat-panel.roughness --iterations 2 --target-spp 4 "
        "--evaluation-spp 4 -o out";
    ASSERT_EQ(run(command).code, 0);
    ASSERT_EQ(run(command).code, 0);
    const Json summary = summary_of("out");
    EXPECT_EQ(summary["deliverables"]["scene"], "scene/scene.xml");
    EXPECT_EQ(summary["deliverables"]["model"], "model.glb");
    EXPECT_EQ(summary["deliverables"]["blender_script"], "import_into_blender.py");
    const auto files = summary["files"].get<std::set<std::string>>();
    for (const char* file :
         {"scene/scene.xml", "scene/color.exr", "model.glb",
          "scene/textures/mat-panel.brdf_0.roughness.data.exr", "import_into_blender.py"})
        EXPECT_TRUE(files.count(file)) << file;
    EXPECT_FALSE(files.count("scene/roughness.exr"));  // replaced: nothing names it
    EXPECT_TRUE(testing::contains(testing::read_text(folder / "out/report.html"), "model.glb"));
}

TEST_F(Deliverables, AFileThatIsCalledTexturesStaysOne) {
    write_scene();
    fs::rename(folder / "color.exr", folder / "textures");
    std::string scene = testing::read_text(folder / "scene.xml");
    scene.replace(scene.find("color.exr"), 9, "textures");
    testing::write_text(folder / "scene.xml", scene);
    const testing::Outcome done =
        run("optimize scene.xml --parameter mat-panel.roughness --iterations 1 --target-spp 1 "
            "--evaluation-spp 1 -o out");
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(read_bytes(folder / "out/scene/textures"), read_bytes(folder / "textures"));
    EXPECT_TRUE(fs::exists(folder / "out/scene/textures_/mat-panel.brdf_0.roughness.data.exr"));
    EXPECT_EQ(run("render out/scene/scene.xml --spp 1 -o a.exr").code, 0);
}

TEST_F(Deliverables, ASceneWhoseFilesHaveGoneIsLeftOutWithAWarning) {
    write_scene();
    const pid_t pid = start(
        "optimize scene.xml --parameter mat-panel.roughness --init 0.5 --time 3600 --target-spp 4 "
        "--evaluation-spp 4 -o out");
    EXPECT_TRUE(testing::wait_for([&] { return iterations_told("out") > 0; }));
    fs::remove(folder / "color.exr");
    kill(pid, SIGINT);
    const int status = testing::end_of(pid);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
    EXPECT_TRUE(testing::contains(testing::read_text(folder / ".err"), "scene is left out"))
        << testing::read_text(folder / ".err");
    EXPECT_FALSE(fs::exists(folder / "out/scene"));
    EXPECT_TRUE(fs::exists(folder / "out/textures"));
    const Json summary = summary_of("out");
    EXPECT_FALSE(summary["deliverables"].contains("scene"));
    const Json inputs =
        materials_of(testing::read_text(folder / "out/import_into_blender.py"))["mat-panel"];
    EXPECT_FALSE(inputs.contains("Base Color")) << inputs;
    EXPECT_EQ(inputs["Roughness"]["file"], "textures/mat-panel.brdf_0.roughness.data.exr");
}

}  // namespace

}  // namespace burnish
