// Values beyond what is meant: who is warned of texels.
#include <gtest/gtest.h>

#include "mitsuba/temporary_scene.h"
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

    const auto most = [&](const std::string& text) {
        return largest_value(load_text(folder, kSeenFromTheSky + text).scene, TextureId{0});
    };
    EXPECT_EQ(most(read("diff_trans", 1)), 2);
    EXPECT_EQ(most(read("spec_trans", 1)), 1);
    EXPECT_EQ(most(both), 1);
    EXPECT_EQ(most(shared + sheet("<ref id='t' name='diff_trans'/><ref id='t' name='sheen'/>")), 1);
}

}  // namespace
}  // namespace burnish
