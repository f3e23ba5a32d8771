// Words that are numbers.
#include "core/parsed.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace burnish {
namespace {

TEST(Parsed, TheWholeWordIsTheNumber) {
    EXPECT_EQ(parsed<double>("-1.5e3"), -1500);
    EXPECT_EQ(parsed<int>("-12"), -12);
    for (const char* word : {"", "+1", " 1", "1 ", "1x", "x", "-"}) {
        EXPECT_EQ(parsed<double>(word), std::nullopt) << word;
        EXPECT_EQ(parsed<int>(word), std::nullopt) << word;
    }
    EXPECT_EQ(parsed<int>("1.5"), std::nullopt);
}

TEST(Parsed, WhatTheTypeDoesNotHoldIsNone) {
    EXPECT_EQ(parsed<double>("1e999"), std::nullopt);
    EXPECT_EQ(parsed<double>("-1e999"), std::nullopt);
    EXPECT_EQ(parsed<float>("1e39"), std::nullopt);
    EXPECT_EQ(parsed<int>("3000000000"), std::nullopt);
    EXPECT_EQ(parsed<std::uint32_t>("-1"), std::nullopt);
}

TEST(Parsed, WhatIsTooCloseToZeroIsZero) {
    EXPECT_EQ(parsed<double>("1e-999"), 0);
    EXPECT_EQ(parsed<double>("-1e-999"), 0);
    EXPECT_EQ(parsed<float>("1e-60"), 0);
    EXPECT_EQ(parsed<double>("1e-999x"), std::nullopt);
}

TEST(Parsed, APlusMayStandBeforeANumberButNotBeforeASign) {
    EXPECT_EQ(without_plus("+5"), "5");
    for (const char* word : {"", "5", "-5", "+-5"}) EXPECT_EQ(without_plus(word), word);
    EXPECT_EQ(parsed<int>(without_plus("+")), std::nullopt);
    EXPECT_EQ(parsed<int>(without_plus("++5")), std::nullopt);
}

}  // namespace
}  // namespace burnish
