// Angles in turns: against the library in double, and packets against floats.
#include "core/angle.h"
#include "worst.h"

#include <gtest/gtest.h>

namespace burnish {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

TEST(Angle, SineAndCosineAreAccurate) {
    double worst = 0;
    for (int i = -100000; i <= 100000; ++i) {
        const float turns = static_cast<float>(i) / 100000;
        const SinCos<float> ours = sin_cos_turns(turns);
        const double angle = kTwoPi * static_cast<double>(turns);
        worst = test::worse(worst, std::abs(static_cast<double>(ours.sin) - std::sin(angle)));
        worst = test::worse(worst, std::abs(static_cast<double>(ours.cos) - std::cos(angle)));
    }
    EXPECT_LT(worst, 2e-7);
    EXPECT_EQ(sin_cos_turns(0.0f).sin, 0.0f);
    EXPECT_EQ(sin_cos_turns(0.25f).cos, 0.0f);
    EXPECT_EQ(sin_cos_turns(0.5f).cos, -1.0f);
}

TEST(Angle, ArcTangentIsAccurate) {
    double worst = 0;
    for (int i = 0; i < 100000; ++i) {
        const double angle = kTwoPi * (i + 0.5) / 100000;
        const auto x = static_cast<float>(3 * std::cos(angle)),
                   y = static_cast<float>(3 * std::sin(angle));
        const double exact = std::atan2(static_cast<double>(y), static_cast<double>(x)) / kTwoPi;
        const double ours = static_cast<double>(atan2_turns(y, x));
        worst = test::worse(worst, std::abs(ours - exact) / std::abs(exact));
    }
    EXPECT_LT(worst, 4e-7);
    EXPECT_EQ(atan2_turns(0.0f, 0.0f), 0.0f);
    EXPECT_EQ(atan2_turns(0.0f, -1.0f), 0.5f);
    EXPECT_EQ(atan2_turns(1.0f, 0.0f), 0.25f);
    EXPECT_EQ(atan2_turns(-1.0f, 0.0f), -0.25f);
}

TEST(Angle, PacketsAgreeWithFloats) {
    for (int i = -500; i < 500; ++i) {
        Packet turns, x;
        for (int k = 0; k < kLanes; ++k) {
            set(turns, k, static_cast<float>(i * kLanes + k) / 3001);
            set(x, k, static_cast<float>(k - 7) / 9);
        }
        const SinCos<Packet> p = sin_cos_turns(turns);
        const Packet angle = atan2_turns(turns, x);
        for (int k = 0; k < kLanes; ++k) {
            const SinCos<float> f = sin_cos_turns(get(turns, k));
            EXPECT_EQ(get(p.sin, k), f.sin);
            EXPECT_EQ(get(p.cos, k), f.cos);
            EXPECT_EQ(get(angle, k), atan2_turns(get(turns, k), get(x, k)));
        }
    }
}

}  // namespace
}  // namespace burnish
