#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "image/image.h"

namespace burnish {
namespace {

TEST(Srgb, KnownValuesAndInverse) {
    EXPECT_FLOAT_EQ(srgb_to_linear(0.5f), 0.21404114f);
    EXPECT_FLOAT_EQ(linear_to_srgb(0.5f), 0.7353569f);
    EXPECT_FLOAT_EQ(srgb_to_linear(0.04f), 0.04f / 12.92f);
    for (int i = 0; i < 256; ++i) {
        const float v = static_cast<float>(i) / 255;
        EXPECT_NEAR(linear_to_srgb(srgb_to_linear(v)), v, 1e-6f);
    }
}

/// The code by its definition.
int rounded(float value) { return static_cast<int>(std::lround(linear_to_srgb(value) * 255.0f)); }

TEST(Srgb, CodesAreThoseOfTheRoundedCurve) {
    const auto one = std::bit_cast<std::uint32_t>(1.0f);
    for (std::uint32_t bits = 0; bits <= one; bits += 499) {
        const auto value = std::bit_cast<float>(bits);
        ASSERT_EQ(code_of(value, true), rounded(value)) << value;
    }
    EXPECT_EQ(code_of(1, true), 255);
}

TEST(Srgb, CodesChangeAtTheSameFloatAsTheRoundedCurve) {
    for (int code = 1; code < 256; ++code) {
        float min = srgb_to_linear((static_cast<float>(code) - 0.5f) / 255);
        for (int i = 0; i < 64; ++i) min = std::nextafter(min, 0.0f);
        bool changes = false;
        for (int i = 0; i < 128; ++i, min = std::nextafter(min, 1.0f)) {
            ASSERT_EQ(code_of(min, true), rounded(min)) << min;
            changes = changes || rounded(min) == code;
        }
        EXPECT_TRUE(changes) << code;
    }
}

TEST(Srgb, CodesOfWhatIsNoColor) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (const bool srgb : {false, true}) {
        for (const float v : {-0.0f, -1.0f, -kInfinity, std::nanf("")})
            EXPECT_EQ(code_of(v, srgb), 0) << v;
        for (const float v : {1.5f, kInfinity}) EXPECT_EQ(code_of(v, srgb), 255) << v;
    }
}

}  // namespace
}  // namespace burnish
