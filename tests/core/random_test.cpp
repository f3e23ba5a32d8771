// Philox against the published test vectors, and packets against floats.
#include "core/random.h"

#include <gtest/gtest.h>

#include "core/random_packet.h"

namespace burnish {
namespace {

using Counter = std::array<std::uint32_t, 4>;

TEST(Random, PhiloxGivesThePublishedNumbers) {
    EXPECT_EQ(philox4x32(Counter{0, 0, 0, 0}, {0, 0}),
              (Counter{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
    EXPECT_EQ(philox4x32(Counter{~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}),
              (Counter{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
    EXPECT_EQ(philox4x32(Counter{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344},
                         {0xa4093822, 0x299f31d0}),
              (Counter{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, PacketsAgreeWithFloats) {
    const RandomKey key{42, Stream::kImage};
    for (std::uint32_t first = 0; first < 4000; first += 1234567u % 97) {
        LaneIntegers sample, iteration, block;
        for (int k = 0; k < kLanes; ++k) {
            const auto i = static_cast<std::uint32_t>(k);
            set(sample, k, first * 2654435761u + i);
            set(iteration, k, first + 3 * i), set(block, k, i % 5);
        }
        const auto packed = uniforms(key, sample, iteration, block);
        for (int k = 0; k < kLanes; ++k) {
            const auto one = uniforms(key, get(sample, k), get(iteration, k), get(block, k));
            for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(get(packed[c], k), one[c]);
        }
    }
}

TEST(Random, UniformsLieBelowOne) {
    EXPECT_EQ(to_unit_float(0), 0.0f);
    EXPECT_LT(to_unit_float(~0u), 1.0f);
}

}  // namespace
}  // namespace burnish
