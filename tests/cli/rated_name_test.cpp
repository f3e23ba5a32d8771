#include "cli/rated_name.h"

#include <gtest/gtest.h>

#include "cli/commands.h"

namespace burnish {
namespace {

TEST(RatedName, RatesFollowTheLastAt) {
    Scene scene;
    scene.parameters = {{"mat-tire.brdf_0.roughness.data", TextureId{0}}};
    const RatedName rated = split_rate(scene, "roughness@0.005");
    EXPECT_EQ(rated.name, "roughness");
    EXPECT_EQ(rated.learning_rate, 0.005);
    EXPECT_EQ(split_rate(scene, "roughness").learning_rate, 0);
    Scene odd;
    odd.parameters = {{"mat@2.roughness", TextureId{0}}};
    odd.constants = {{"mat@3.brdf_0.metallic.value", BsdfId{0}}};
    EXPECT_EQ(split_rate(odd, "mat@2.roughness").name, "mat@2.roughness");
    EXPECT_EQ(split_rate(odd, "mat@2.roughness@3").learning_rate, 3);
    for (const char* name : {"mat@3.metallic", "mat@3.metallic:16"}) {
        EXPECT_EQ(split_rate(odd, name).name, name);
        EXPECT_EQ(split_rate(odd, std::string(name) + "@0.5").learning_rate, 0.5) << name;
    }
    for (const char* bad : {"roughness@", "roughness@-1", "roughness@0", "roughness@fast", "@0.1"})
        EXPECT_THROW(split_rate(scene, bad), UsageError) << bad;
}

}  // namespace
}  // namespace burnish
