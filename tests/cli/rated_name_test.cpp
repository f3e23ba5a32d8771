#include "cli/rated_name.h"

#include <gtest/gtest.h>

#include "cli/commands.h"

namespace burnish {
namespace {

TEST(RatedName, RatesFollowTheLastAt) {
    const std::vector<Parameter> parameters{{"mat-tire.brdf_0.roughness.data", TextureId{0}}};
    const RatedName rated = split_rate(parameters, "roughness@0.005");
    EXPECT_EQ(rated.name, "roughness");
    EXPECT_EQ(rated.learning_rate, 0.005);
    EXPECT_EQ(split_rate(parameters, "roughness").learning_rate, 0);
    const std::vector<Parameter> odd{{"mat@2.roughness", TextureId{0}}};
    EXPECT_EQ(split_rate(odd, "mat@2.roughness").name, "mat@2.roughness");
    EXPECT_EQ(split_rate(odd, "mat@2.roughness@3").learning_rate, 3);
    for (const char* bad : {"roughness@", "roughness@-1", "roughness@0", "roughness@fast"})
        EXPECT_THROW(split_rate(parameters, bad), UsageError) << bad;
}

}  // namespace
}  // namespace burnish
