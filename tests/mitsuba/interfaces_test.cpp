// BSDFs of interfaces as the scene language gives them: indices by name, roughness, parameters.
#include <gtest/gtest.h>

#include "error_of.h"
#include "mitsuba/temporary_scene.h"
#include "scene/constants.h"
#include "shading/rough_plastic.h"

namespace burnish {
namespace {

const std::string kBesides =
    "<sensor type='perspective'/><integrator type='direct'/><emitter type='constant'/>";

Scene load_interface(const TemporaryFolder& folder, const std::string& bsdf) {
    const LoadedScene loaded =
        load_text(folder, kBesides + "<shape type='rectangle'>" + bsdf + "</shape>");
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings[0];
    return loaded.scene;
}

std::vector<std::string> names_of(const Scene& scene) {
    std::vector<std::string> names;
    for (const Parameter& p : scene.parameters) names.push_back(p.name);
    for (const ConstantParameter& c : scene.constants) names.push_back(c.name);
    return names;
}

TEST(InterfaceScenes, MetalsByNameAndByNumber) {
    const TemporaryFolder folder;
    const Scene gold = load_interface(
        folder, "<bsdf type='conductor'><string name='material' value='Au'/></bsdf>");
    const auto& au = std::get<Conductor>(gold.bsdfs[0]);
    EXPECT_FLOAT_EQ(au.index.eta.y, 0.3753071f);
    EXPECT_FLOAT_EQ(au.index.k.x, 3.982997f);
    EXPECT_EQ(au.reflectance.constant, (Rgbf{1, 1, 1}));
    const Scene other = load_interface(
        folder, "<bsdf type='roughconductor'><string name='material' value='W_palik'/></bsdf>");
    EXPECT_FLOAT_EQ(std::get<RoughConductor>(other.bsdfs[0]).index.eta.x, 4.370817f);
    for (const auto& [name, k] :
         {std::pair{"AlSb", 1.30057f}, std::pair{"Se-e", 1.56532f},
          std::pair{"Te-e_palik", 3.997592f}, std::pair{"TiO2-e", 0.0001826981f}}) {
        const Scene scene = load_interface(
            folder, std::string("<bsdf type='conductor'><string name='material' value='") + name +
                        "'/></bsdf>");
        EXPECT_FLOAT_EQ(std::get<Conductor>(scene.bsdfs[0]).index.k.z, k) << name;
    }
    const Scene given = load_interface(
        folder,
        "<bsdf type='roughconductor'><rgb name='eta' value='1 2 3'/><float name='k' value='4'/>"
        "<float name='alpha_u' value='0.2'/><float name='alpha_v' value='0.3'/><string "
        "name='distribution' value='ggx'/><boolean name='sample_visible' value='false'/></bsdf>");
    const auto& b = std::get<RoughConductor>(given.bsdfs[0]);
    EXPECT_EQ(b.index.eta, (Rgbf{1, 2, 3}));
    EXPECT_EQ(b.index.k, (Rgbf{4, 4, 4}));
    EXPECT_EQ(b.roughness.shape, FacetShape::kGgx);
    EXPECT_TRUE(b.roughness.anisotropic);
    EXPECT_EQ(b.roughness.alpha[1].constant, 0.3f);
}

TEST(InterfaceScenes, MirrorAndBeckmannAreTheDefaults) {
    const TemporaryFolder folder;
    const auto b =
        std::get<RoughConductor>(load_interface(folder, "<bsdf type='roughconductor'/>").bsdfs[0]);
    EXPECT_EQ(b.index.eta, (Rgbf{0, 0, 0}));
    EXPECT_EQ(b.index.k, (Rgbf{1, 1, 1}));
    EXPECT_EQ(b.roughness.shape, FacetShape::kBeckmann);
    EXPECT_FALSE(b.roughness.anisotropic);
    EXPECT_EQ(b.roughness.alpha[0].constant, 0.1f);
}

/// As in Mitsuba.
TEST(InterfaceScenes, DistributionsMayBeWrittenInCapitals) {
    const TemporaryFolder folder;
    const auto read = [&](const std::string& type, const char* distribution) {
        return load_interface(folder, "<bsdf type='" + type +
                                          "'><string name='distribution' value='" + distribution +
                                          "'/></bsdf>")
            .bsdfs[0];
    };
    for (const auto& [word, shape] :
         {std::pair{"GGX", FacetShape::kGgx}, {"Beckmann", FacetShape::kBeckmann}}) {
        EXPECT_EQ(std::get<RoughConductor>(read("roughconductor", word)).roughness.shape, shape);
        EXPECT_EQ(std::get<RoughDielectric>(read("roughdielectric", word)).roughness.shape, shape);
        EXPECT_EQ(std::get<RoughPlastic>(read("roughplastic", word)).shape, shape);
    }
}

TEST(InterfaceScenes, PlasticsWithTheirIndices) {
    const TemporaryFolder folder;
    const auto plain = std::get<Plastic>(load_interface(folder, "<bsdf type='plastic'/>").bsdfs[0]);
    EXPECT_FLOAT_EQ(plain.eta, static_cast<float>(1.49 / 1.000277));
    EXPECT_EQ(plain.colors[0].constant, (Rgbf{0.5f, 0.5f, 0.5f}));
    EXPECT_EQ(plain.colors[1].constant, (Rgbf{1, 1, 1}));
    const auto rough = std::get<RoughPlastic>(
        load_interface(
            folder,
            "<bsdf type='roughplastic'><string name='int_ior' value='Diamond'/><float "
            "name='ext_ior' value='1.2'/><boolean name='nonlinear' value='true'/><float "
            "name='alpha' value='0.3'/><rgb name='diffuse_reflectance' value='0.1 0.2 0.3'/>"
            "<rgb name='specular_reflectance' value='0.4 0.5 0.6'/></bsdf>")
            .bsdfs[0]);
    EXPECT_FLOAT_EQ(rough.eta, static_cast<float>(2.419 / 1.2));
    EXPECT_TRUE(rough.nonlinear);
    EXPECT_EQ(rough.alpha, 0.3f);
    EXPECT_EQ(rough.colors[1].constant, (Rgbf{0.4f, 0.5f, 0.6f}));
    EXPECT_GT(rough.transmittance.back(), 0.7f) << "made when read";
    EXPECT_GT(rough.internal_reflectance, 0.5f);
}

TEST(InterfaceScenes, RoughPlasticsHaveTheTablesOfTheirOwnRoughness) {
    const TemporaryFolder folder;
    std::string text;
    for (const char* alpha : {"0.1", "0.3", "0.1", "0.05"})
        text += std::string("<bsdf type='roughplastic'><float name='alpha' value='") + alpha +
                "'/></bsdf>";
    const Scene scene = load_text(folder, text).scene;
    ASSERT_EQ(scene.bsdfs.size(), 4u);
    for (const Bsdf& bsdf : scene.bsdfs) {
        const auto& loaded = std::get<RoughPlastic>(bsdf);
        const RoughPlastic made = make_rough_plastic(loaded);
        EXPECT_EQ(loaded.transmittance, made.transmittance);
        EXPECT_EQ(loaded.internal_reflectance, made.internal_reflectance);
    }
}

TEST(InterfaceScenes, GlassPanesAndNothing) {
    const TemporaryFolder folder;
    const auto read = [&](const char* type) {
        return load_interface(folder, std::string("<bsdf type='") + type + "'/>").bsdfs[0];
    };
    const float bk7 = static_cast<float>(1.5046 / 1.000277);
    const auto glass = std::get<Dielectric>(read("dielectric"));
    EXPECT_FLOAT_EQ(glass.eta, bk7);
    EXPECT_FALSE(glass.thin);
    const auto pane = std::get<Dielectric>(read("thindielectric"));
    EXPECT_FLOAT_EQ(pane.eta, bk7);
    EXPECT_TRUE(pane.thin);
    const auto nothing = std::get<Dielectric>(read("null"));
    EXPECT_EQ(nothing.eta, 1);
    EXPECT_TRUE(nothing.thin);
    const auto rough = std::get<RoughDielectric>(read("roughdielectric"));
    EXPECT_FLOAT_EQ(rough.eta, bk7);
    EXPECT_EQ(rough.roughness.alpha[0].constant, 0.1f);
    const auto colored = std::get<RoughDielectric>(
        load_interface(folder,
                       "<bsdf type='roughdielectric'><rgb name='specular_reflectance' "
                       "value='.1 .2 .3'/><rgb name='specular_transmittance' value='.4 .5 .6'/>"
                       "<float name='int_ior' value='1.2'/><float name='ext_ior' value='1.5'/>"
                       "</bsdf>")
            .bsdfs[0]);
    EXPECT_FLOAT_EQ(colored.eta, 0.8f);
    EXPECT_EQ(colored.colors[0].constant, (Rgbf{0.1f, 0.2f, 0.3f}));
    EXPECT_EQ(colored.colors[1].constant, (Rgbf{0.4f, 0.5f, 0.6f}));
}

TEST(InterfaceScenes, Sheets) {
    const TemporaryFolder folder;
    const Scene scene = load_interface(
        folder,
        "<bsdf type='principledthin' id='s'><float name='diff_trans' value='1.5'/><float "
        "name='eta' value='1.3'/><float name='spec_trans' value='0.4'/><float "
        "name='diffuse_transmittance_sampling_rate' value='2'/></bsdf>");
    const auto& b = std::get<PrincipledThin>(scene.bsdfs[0]);
    EXPECT_EQ(b.scalars[static_cast<std::size_t>(ThinScalar::kRoughness)].constant, 0.5f);
    EXPECT_EQ(b.scalars[static_cast<std::size_t>(ThinScalar::kSpecTrans)].constant, 0.4f);
    EXPECT_EQ(b.scalars[static_cast<std::size_t>(ThinScalar::kDiffTrans)].constant, 1.5f);
    EXPECT_EQ(b.eta, 1.3f);
    EXPECT_EQ(b.rates, (std::array<float, 4>{1, 1, 1, 2}));
    EXPECT_TRUE(transmits(scene.bsdfs[0]));
    const auto names = names_of(scene);
    EXPECT_EQ(names.size(), 9u);
    EXPECT_EQ(names[8], "s.diff_trans.value");
}

TEST(InterfaceScenes, InputsHaveMitsubasNames) {
    const TemporaryFolder folder;
    write_image(folder.path / "map.exr", make_image(2, 2, 1, 0.3f));
    const std::string texture =
        "<texture type='bitmap' name='NAME'><string name='filename' value='map.exr'/></texture>";
    const auto named = [&](const char* name) {
        std::string text = texture;
        return text.replace(text.find("NAME"), 4, name);
    };
    Scene scene =
        load_interface(folder, "<bsdf type='roughconductor' id='m'>" + named("alpha") + "</bsdf>");
    EXPECT_EQ(names_of(scene),
              (std::vector<std::string>{"m.alpha.data", "m.specular_reflectance.value"}));
    EXPECT_TRUE(bool(std::get<RoughConductor>(scene.bsdfs[0]).roughness.alpha[0].texture));
    scene = load_interface(
        folder, "<bsdf type='roughplastic' id='p'>" + named("specular_reflectance") + "</bsdf>");
    EXPECT_EQ(names_of(scene), (std::vector<std::string>{"p.specular_reflectance.data",
                                                         "p.diffuse_reflectance.value"}));
    EXPECT_TRUE(bool(std::get<RoughPlastic>(scene.bsdfs[0]).colors[1].texture));
}

/// A constant of any place becomes a texture of its value.
TEST(InterfaceScenes, ConstantsBecomeTextures) {
    const TemporaryFolder folder;
    Scene metal = load_interface(
        folder,
        "<bsdf type='roughconductor' id='m'><float name='alpha_u' value='0.2'/><float "
        "name='alpha_v' value='0.3'/></bsdf>");
    require_parameter(metal, "m.alpha_v");
    const auto& b = std::get<RoughConductor>(metal.bsdfs[0]);
    EXPECT_FALSE(bool(b.roughness.alpha[0].texture));
    ASSERT_TRUE(bool(b.roughness.alpha[1].texture));
    EXPECT_EQ(std::get<Bitmap>(metal[b.roughness.alpha[1].texture]).values[0], 0.3f);
    Scene plastic = load_interface(
        folder,
        "<bsdf type='roughplastic' id='p'><rgb name='specular_reflectance' value='.1 .2 .3'/>"
        "</bsdf>");
    require_parameter(plastic, "p.specular_reflectance");
    const auto& p = std::get<RoughPlastic>(plastic.bsdfs[0]);
    ASSERT_TRUE(bool(p.colors[1].texture));
    EXPECT_EQ(std::get<Bitmap>(plastic[p.colors[1].texture]).values,
              (std::vector<float>{0.1f, 0.2f, 0.3f}));
}

TEST(InterfaceScenes, BadOnesAreRefusedWithTheirPlace) {
    const TemporaryFolder folder;
    const auto complaint = [&](const std::string& bsdf) {
        return test::error_of([&] { load_interface(folder, "\n" + bsdf); });
    };
    const auto expect = [&](const std::string& bsdf, const std::string& words) {
        const std::string text = complaint(bsdf);
        EXPECT_NE(text.find(words), std::string::npos) << text;
        EXPECT_NE(text.find(":3:"), std::string::npos) << text;
    };
    expect("<bsdf type='conductor'><string name='material' value='Unobtainium'/></bsdf>",
           "\"material\" is \"Unobtainium\", expected none, a-C, Ag, Al");
    expect(
        "<bsdf type='conductor'><string name='material' value='Au'/><rgb name='eta' "
        "value='1 2 3'/></bsdf>",
        "found both \"material\" and \"eta\"");
    expect("<bsdf type='conductor'><rgb name='eta' value='1 -2 3'/></bsdf>",
           "\"eta\" is (1, -2, 3), expected no negative value");
    expect("<bsdf type='roughconductor'><float name='k' value='-1'/></bsdf>",
           "\"k\" is (-1, -1, -1), expected no negative value");
    expect("<bsdf type='conductor'><spectrum name='eta' value='-1'/></bsdf>",
           "\"eta\" is (-1, -1, -1), expected no negative value");
    expect(
        "<bsdf type='conductor'><spectrum name='eta' type='rawconstant'><vector name='value' "
        "value='-2, 1, 1'/></spectrum></bsdf>",
        "\"eta\" is (-2, 1, 1), expected no negative value");
    expect("<bsdf type='roughconductor'><float name='alpha_u' value='0.2'/></bsdf>",
           "found \"alpha_u\" alone, expected both");
    expect(
        "<bsdf type='roughconductor'><float name='alpha' value='0.2'/><float name='alpha_v' "
        "value='0.2'/></bsdf>",
        "found \"alpha\" beside");
    expect("<bsdf type='roughconductor'><string name='distribution' value='phong'/></bsdf>",
           "\"distribution\" is \"phong\", expected beckmann, ggx");
    expect("<bsdf type='plastic'><string name='int_ior' value='jelly'/></bsdf>",
           "\"int_ior\" is \"jelly\", expected a number or vacuum, helium");
    expect("<bsdf type='plastic'><float name='int_ior' value='-1'/></bsdf>",
           "\"int_ior\" is -1, expected a number above 0");
    expect("<bsdf type='plastic'><string name='int_ior' value='air'/></bsdf>", "are the same");
    for (const char* type : {"plastic", "roughplastic", "dielectric", "roughdielectric"})
        for (const auto& [inside, outside] :
             {std::pair{"3e38", "1e-3"}, std::pair{"1e-30", "1e30"}, std::pair{"1e30", "1e-300"}})
            expect("<bsdf type='" + std::string(type) + "'><float name='int_ior' value='" + inside +
                       "'/><float name='ext_ior' value='" + outside + "'/></bsdf>",
                   "\"int_ior\" / \"ext_ior\" is ");
    for (const char* alpha : {"-1", "12"})
        expect("<bsdf type='roughplastic'><float name='alpha' value='" + std::string(alpha) +
                   "'/></bsdf>",
               "\"alpha\" is " + std::string(alpha) + ", expected a number in [0, 10]");
}

}  // namespace
}  // namespace burnish
