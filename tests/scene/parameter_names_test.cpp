#include "scene/parameter_names.h"

#include <gtest/gtest.h>

#include "burnish/error.h"
#include "error_of.h"

namespace burnish {
namespace {

const std::vector<Parameter> kParameters{{"mat-tire.brdf_0.base_color.data", TextureId{0}},
                                         {"mat-tire.brdf_0.roughness.data", TextureId{1}},
                                         {"mat-rim.brdf_0.roughness.data", TextureId{2}},
                                         {"mat-hub.brdf_0.clearcoat.data", TextureId{3}},
                                         {"mat-cap.brdf_0.clearcoat.data", TextureId{3}}};

std::string error_of(const std::string& name) {
    return test::error_of([&] { find_parameter(kParameters, name); });
}

TEST(ParameterNames, ShortFormsAreSubsequencesOfTheParts) {
    const std::string full = "mat-tire.brdf_0.roughness.data";
    for (const char* s : {"mat-tire.brdf_0.roughness.data", "mat-tire.roughness", "roughness",
                          "brdf_0.roughness", "mat-tire.data"})
        EXPECT_NE(match_name(s, full), NameMatch::kNone) << s;
    for (const char* s : {"roughness.mat-tire", "rough", "mat-tire.roughness.roughness", "", "."})
        EXPECT_EQ(match_name(s, full), NameMatch::kNone) << s;
}

TEST(ParameterNames, PlainNamesLeaveOutTheSideAndTheLastPart) {
    const std::string full = "mat-tire.001.brdf_1.roughness.data";
    EXPECT_EQ(match_name(full, full), NameMatch::kFullName);
    for (const char* plain :
         {"mat-tire.001.roughness", "mat-tire.001.brdf_1.roughness", "mat-tire.001.roughness.data"})
        EXPECT_EQ(match_name(plain, full), NameMatch::kPlainName) << plain;
    for (const char* s : {"mat-tire.roughness", "001.roughness", "brdf_1.roughness", "data"})
        EXPECT_EQ(match_name(s, full), NameMatch::kShortForm) << s;
    EXPECT_EQ(match_name("mat-tire.001.brdf_0.roughness", full), NameMatch::kNone);
}

TEST(ParameterNames, FindsTheOneThatIsMeant) {
    EXPECT_EQ(find_parameter(kParameters, "mat-tire.brdf_0.roughness.data"), 1u);
    EXPECT_EQ(find_parameter(kParameters, "mat-rim.roughness"), 2u);
    EXPECT_EQ(find_parameter(kParameters, "base_color"), 0u);
}

TEST(ParameterNames, SharedTexturesAreNoAmbiguity) {
    EXPECT_EQ(find_parameter(kParameters, "clearcoat"), 3u);
}

TEST(ParameterNames, AFullNameWinsOverShortForms) {
    const std::vector<Parameter> nested{{"a.b.c", TextureId{0}}, {"a.c", TextureId{1}}};
    EXPECT_EQ(find_parameter(nested, "a.c"), 1u);
}

/// Blender calls the second material beside "Material" "Material.001".
TEST(ParameterNames, APlainNameWinsOverOtherShortForms) {
    const std::vector<Parameter> two{{"mat-Material.001.brdf_0.base_color.data", TextureId{0}},
                                     {"mat-Material.brdf_0.base_color.value", TextureId{1}},
                                     {"mat-Material.brdf_1.base_color.value", TextureId{2}},
                                     {"mat-Other.base_color.value", TextureId{3}}};
    EXPECT_EQ(find_parameter(two, "mat-Material.001.base_color"), 0u);
    EXPECT_EQ(find_parameter(two, "mat-Material.brdf_0.base_color"), 1u);
    EXPECT_EQ(find_parameter(two, "mat-Other.base_color"), 3u);
    EXPECT_EQ(test::error_of([&] { find_parameter(two, "mat-Material.base_color"); }),
              "the parameter name 'mat-Material.base_color' is ambiguous, it matches: "
              "mat-Material.brdf_0.base_color.value, mat-Material.brdf_1.base_color.value");
}

TEST(ParameterNames, AmbiguousNamesListTheirMatches) {
    EXPECT_EQ(error_of("roughness"),
              "the parameter name 'roughness' is ambiguous, it matches: "
              "mat-tire.brdf_0.roughness.data, mat-rim.brdf_0.roughness.data");
}

TEST(ParameterNames, UnknownNamesListTheNearest) {
    EXPECT_EQ(error_of("mat-tyre.roughness"),
              "no parameter is called 'mat-tyre.roughness', did you mean: "
              "mat-tire.brdf_0.roughness.data");
    EXPECT_EQ(
        error_of("base_colour"),
        "no parameter is called 'base_colour', did you mean: mat-tire.brdf_0.base_color.data");
}

/// "metalic" is one letter from one name and two from the other.
TEST(ParameterNames, NamesThatAreNearlyAsNearAreListedBehindTheNearest) {
    const std::vector<Parameter> parameters{{"m.metallics.data", TextureId{0}},
                                            {"m.metallic.data", TextureId{1}},
                                            {"m.roughness.data", TextureId{2}}};
    try {
        find_parameter(parameters, "metalic");
        ADD_FAILURE() << "expected an InputError";
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(),
                     "no parameter is called 'metalic', did you mean: m.metallic.data, "
                     "m.metallics.data");
    }
}

TEST(ParameterNames, NamesFarFromAllListAll) {
    const std::string error = error_of("xyzzyxyzzy");
    EXPECT_EQ(error.find("no parameter is called 'xyzzyxyzzy', expected one of mat-"), 0u) << error;
    for (const Parameter& p : kParameters) EXPECT_NE(error.find(p.name), std::string::npos);
}

TEST(ParameterNames, LongListsEndWithHowManyAreLeft) {
    std::vector<std::string> names(12, "a");
    EXPECT_EQ(list_of({}), "");
    EXPECT_EQ(list_of(names), "a, a, a, a, a, a, a, a, a, a, a, a");
    names.insert(names.end(), {"b", "b"});
    EXPECT_EQ(list_of(names), "a, a, a, a, a, a, a, a, a, a, a, a and 2 more");
}

TEST(ParameterNames, EditDistance) {
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
    EXPECT_EQ(edit_distance("", "abc"), 3u);
    EXPECT_EQ(edit_distance("abc", "abc"), 0u);
    EXPECT_EQ(edit_distance("acb", "abc"), 1u);
}

TEST(ParameterNames, TwoOfOneTextureAreBothNamed) {
    EXPECT_NO_THROW(require_distinct({"a", "b"}, {{0}, {1}}));
    try {
        require_distinct({"a", "b", "c"}, {{0}, {1}, {0}});
        ADD_FAILURE() << "expected an InputError";
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "the parameters a and c are one texture");
    }
    EXPECT_EQ(test::error_of([] {
                  require_distinct({"a", "a"}, {{0}, {0}});
              }),
              "the parameter a is given twice");
}

}  // namespace
}  // namespace burnish
