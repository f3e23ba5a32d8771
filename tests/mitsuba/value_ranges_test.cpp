// Values beyond what is meant: who is warned of texels, and how wide filters may be.
#include <gtest/gtest.h>

#include "mitsuba/temporary_scene.h"
#include "render/film.h"
#include "scene/value_range.h"

namespace burnish {
namespace {

const std::string kSeenFromTheSky =
    "<sensor type='perspective'/><integrator type='direct'/><emitter type='constant'/>";

/// A bitmap of four texels.
std::string square_texture(const TemporaryFolder& folder, float value,
                           const std::string& attributes) {
    write_image(folder.path / "t.exr", make_image(2, 2, 1, value));
    return "<texture type='bitmap' " + attributes +
           "><string name='filename' value='t.exr'/><boolean name='raw' value='true'/></texture>";
}

std::string on_a_square(const std::string& inside) {
    return "<shape type='rectangle'>" + inside + "</shape>";
}

std::vector<std::string> warnings_about(const TemporaryFolder& folder, const std::string& text) {
    return load_text(folder, kSeenFromTheSky + text).warnings;
}

void expect_one_warning(const std::vector<std::string>& found, const std::string& text) {
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NE(found[0].find(text), std::string::npos) << found[0];
}

const std::string kTexturedLight =
                      on_a_square("<emitter type='area'><ref id='t' name='radiance'/></emitter>"),
                  kBumpySquare = on_a_square(
                      "<bsdf type='bumpmap'><ref id='t'/><bsdf type='diffuse'/></bsdf>"),
                  kMattSquare =
                      on_a_square("<bsdf type='diffuse'><ref id='t' name='reflectance'/></bsdf>");

TEST(ValuesOutside, AreWarnedOfWhereAMaterialReadsThem) {
    const TemporaryFolder folder;
    const std::string bright = square_texture(folder, 7, "id='t'");
    EXPECT_TRUE(warnings_about(folder, bright).empty()) << "nobody reads it";
    EXPECT_TRUE(warnings_about(folder, bright + kTexturedLight + kBumpySquare).empty());
    expect_one_warning(warnings_about(folder, bright + kMattSquare),
                       "the texture \"t.exr\" has 4 values outside [0,");
    expect_one_warning(warnings_about(folder, bright + kTexturedLight + kMattSquare + kMattSquare),
                       "outside [0, 1]");
    expect_one_warning(warnings_about(folder, kMattSquare + kBumpySquare + bright),
                       "outside [0, 1]");
}

TEST(ValuesOutside, DiffTransGoesToTwo) {
    const TemporaryFolder folder;
    const auto sheet = [](const std::string& input) {
        return on_a_square("<bsdf type='principledthin' id='m'>" + input + "</bsdf>");
    };
    const auto read = [&](const char* name, float value) {
        return sheet(square_texture(folder, value, std::string("name='") + name + "'"));
    };
    EXPECT_TRUE(warnings_about(folder, read("diff_trans", 1.5f)).empty());
    expect_one_warning(warnings_about(folder, read("diff_trans", 2.5f)),
                       "has 4 values outside [0, 2]");
    expect_one_warning(warnings_about(folder, read("spec_trans", 1.5f)),
                       "has 4 values outside [0, 1]");
    expect_one_warning(warnings_about(folder, sheet("<float name='diff_trans' value='2.5'/>")),
                       "in [0, 2]");
    const std::string shared = square_texture(folder, 1.5f, "id='t'"),
                      both = shared + sheet("<ref id='t' name='diff_trans'/>") + kMattSquare;
    expect_one_warning(warnings_about(folder, both), "has 4 values outside [0, 1]");

    const auto max = [&](const std::string& text) {
        return largest_value(load_text(folder, kSeenFromTheSky + text).scene, TextureId{0});
    };
    EXPECT_EQ(max(read("diff_trans", 1)), 2);
    EXPECT_EQ(max(read("spec_trans", 1)), 1);
    EXPECT_EQ(max(both), 1);
    EXPECT_EQ(max(shared + sheet("<ref id='t' name='diff_trans'/><ref id='t' name='sheen'/>")), 1);
}

TEST(WideFilters, AreThoseOfTheRenderer) {
    const TemporaryFolder folder;
    const auto film = [](const std::string& type, const std::string& number) {
        return "<emitter type='constant'/><sensor type='perspective'><film type='hdrfilm'><rfilter "
               "type='" +
               type + "'>" + number + "</rfilter></film></sensor>";
    };
    const auto reads = [&](const std::string& type, const std::string& number) {
        EXPECT_EQ(filter_halo(load_text(folder, film(type, number)).scene.film.filter), 7) << type;
    };
    reads("box", "<float name='radius' value='7.5'/>");
    reads("tent", "<float name='radius' value='7.5'/>");
    reads("gaussian", "<float name='stddev' value='1.875'/>");
    reads("lanczos", "<integer name='lobes' value='7'/>");
    const auto complains = [&](const std::string& type, const std::string& number,
                               const std::string& text) {
        const std::string error = error_of(write_text(
            folder, "scene.xml", "<scene version='3.0.0'>\n" + film(type, number) + "</scene>"));
        EXPECT_NE(error.find("scene.xml:2:"), std::string::npos) << error;
        EXPECT_NE(error.find(text), std::string::npos) << error;
    };
    complains("box", "<float name='radius' value='7.6'/>",
              "\"radius\" is 7.6, expected a value in [0.5, 7.5]");
    complains("gaussian", "<float name='stddev' value='1.9'/>",
              "\"stddev\" is 1.9, expected a value in [0.05, 1.875]");
    complains("lanczos", "<integer name='lobes' value='8'/>",
              "\"lobes\" is \"8\", expected an integer in [1, 7]");
}

}  // namespace
}  // namespace burnish
