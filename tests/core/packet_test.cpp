// Packets: masks, lanes and loads. Arithmetic is compared with floats in dual_test.cpp.
#include "core/packet.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>

namespace burnish {
namespace {

Packet ramp() {
    Packet p;
    for (int i = 0; i < kLanes; ++i) set(p, i, static_cast<float>(i));
    return p;
}

TEST(Packet, StartsAtZeroAndBroadcasts) {
    for (int i = 0; i < kLanes; ++i) {
        EXPECT_EQ(get(Packet(), i), 0.0f);
        EXPECT_EQ(get(Packet(2.5), i), 2.5f);
        EXPECT_FALSE(get(Mask(), i));
        EXPECT_TRUE(get(Mask(true), i));
    }
}

TEST(Packet, MasksAreLogicPerLane) {
    const Packet p = ramp();
    const Mask low = p < Packet(5.0f), even = select(p == Packet(2.0f), p, Packet(0.0f)) == p;
    for (int i = 0; i < kLanes; ++i) {
        const bool a = i < 5, b = i == 0 || i == 2;
        EXPECT_EQ(get(low && even, i), a && b);
        EXPECT_EQ(get(low || even, i), a || b);
        EXPECT_EQ(get(!low, i), !a);
    }
    EXPECT_TRUE(any(low));
    EXPECT_FALSE(all(low));
    EXPECT_FALSE(any(p < Packet(0.0f)));
    EXPECT_TRUE(all(p >= Packet(0.0f)));
}

TEST(Packet, EveryLaneDecidesAnyAndAll) {
    for (int i = 0; i < kLanes; ++i) {
        Mask one(false), all_but_one(true);
        set(one, i, true);
        set(all_but_one, i, false);
        EXPECT_TRUE(any(one)) << i;
        EXPECT_FALSE(all(all_but_one)) << i;
    }
}

TEST(Packet, LoadsAndStoresUnaligned) {
    std::array<float, kLanes + 1> from{}, to{};
    for (std::size_t i = 0; i < from.size(); ++i) from[i] = static_cast<float>(i * i);
    store(to.data() + 1, load(from.data() + 1));
    for (std::size_t i = 1; i < from.size(); ++i) EXPECT_EQ(to[i], from[i]);
    EXPECT_EQ(to[0], 0.0f);
}

TEST(Packet, FunctionsAreThoseOfFloats) {
    // Unknown to the compiler, which would otherwise fold some of the calls with its own rounding.
    volatile float seven = 7.0f;
    const Packet p = ramp() / Packet(static_cast<float>(seven)) + Packet(0.01f);
    for (int i = 0; i < kLanes; ++i) {
        const float x = get(p, i);
        EXPECT_EQ(get(sqrt(p), i), std::sqrt(x));
        EXPECT_EQ(get(log(p), i), std::log(x));
        EXPECT_EQ(get(exp(p), i), std::exp(x));
        EXPECT_EQ(get(erf(p), i), std::erf(x));
        EXPECT_EQ(get(floor(p), i), std::floor(x));
        EXPECT_EQ(get(abs(-p), i), x);
    }
}

TEST(Scalar, InverseErfIsTheInverse) {
    for (const double x : {-3.4, -2.5, -1.0, -0.1, 0.0, 1e-4, 0.3, 1.2, 2.2, 3.4}) {
        const double found = inverse_erf(std::erf(x));
        EXPECT_NEAR(found, x, 2e-6 * std::abs(x));
        EXPECT_EQ(get(inverse_erf(Packet(static_cast<float>(std::erf(x)))), 3),
                  inverse_erf(static_cast<float>(std::erf(x))));
    }
}

TEST(Packet, TransposesAndGathers) {
    PacketBlock block;
    for (int i = 0; i < kLanes; ++i)
        for (int k = 0; k < kLanes; ++k)
            set(block[static_cast<std::size_t>(i)], k, static_cast<float>(100 * i + k));
    transpose(block);
    for (int i = 0; i < kLanes; ++i)
        for (int k = 0; k < kLanes; ++k)
            EXPECT_EQ(get(block[static_cast<std::size_t>(i)], k), static_cast<float>(100 * k + i));
    std::array<float, 50> from;
    std::array<int, kLanes> index;
    for (std::size_t i = 0; i < from.size(); ++i) from[i] = static_cast<float>(i * i);
    for (int i = 0; i < kLanes; ++i) index[static_cast<std::size_t>(i)] = (7 * i) % 50;
    const Packet p = gather(from.data(), index.data());
    for (int i = 0; i < kLanes; ++i)
        EXPECT_EQ(get(p, i), from[static_cast<std::size_t>((7 * i) % 50)]);
}

TEST(Packet, ConvertsIntegersExactly) {
    LaneIntegers n;
    for (int i = 0; i < kLanes; ++i) set(n, i, 0x7fffff80u >> (2 * i));  // all are floats
    const Packet p = to_floats(n);
    const LaneIntegers back = to_integers(p);
    for (int i = 0; i < kLanes; ++i) {
        EXPECT_EQ(get(p, i), static_cast<float>(get(n, i)));
        EXPECT_EQ(get(back, i), get(n, i));
    }
    EXPECT_TRUE(all(back == n));
}

TEST(Packet, CountsLikeIntegers) {
    std::array<std::uint32_t, kLanes> x, y;
    for (std::uint32_t i = 0; i < kLanes; ++i)
        x[i] = 0x9e3779b9u * (i + 1), y[i] = 0xbb67ae85u * (i + 3) >> i;
    const LaneIntegers a = load(x.data()), b = load(y.data());
    LaneIntegers sum = a, either = a;
    sum += b, either ^= b;
    for (int i = 0; i < kLanes; ++i) {
        const std::uint32_t p = x[static_cast<std::size_t>(i)], q = y[static_cast<std::size_t>(i)];
        EXPECT_EQ(get(a + b, i), p + q);
        EXPECT_EQ(get(sum, i), p + q);
        EXPECT_EQ(get(a - b, i), p - q);
        EXPECT_EQ(get(a * b, i), p * q);
        EXPECT_EQ(get(a / b, i), p / q);
        EXPECT_EQ(get(a % b, i), p % q);
        EXPECT_EQ(get(a & b, i), p & q);
        EXPECT_EQ(get(a | b, i), p | q);
        EXPECT_EQ(get(either, i), p ^ q);
        EXPECT_EQ(get(a << 7, i), p << 7);
        EXPECT_EQ(get(a >> 9, i), p >> 9);
        EXPECT_EQ(get(a == LaneIntegers(x[5]), i), i == 5);
    }
}

TEST(Packet, NanComparesFalse) {
    const Packet nan(NAN);
    EXPECT_FALSE(any(nan < Packet(1.0f) || nan > Packet(1.0f) || nan == nan));
    EXPECT_EQ(get(max(nan, Packet(3.0f)), 4), 3.0f);
    EXPECT_EQ(max(NAN, 3.0f), 3.0f);
}

}  // namespace
}  // namespace burnish
