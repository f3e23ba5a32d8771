// Sums over texels in bands: those of a plain loop, and empty again after folding.
#include "gradient/texel_sums.h"

#include <gtest/gtest.h>

#include "gradient/split_gradient.h"
#include "random_source.h"

namespace burnish {
namespace {

/// Adds random values to random texels of `bands` bands, and to a plain image.
Image fill(TexelSums& sums, std::uint32_t seed) {
    Image plain = make_image(static_cast<int>(sums.width), static_cast<int>(sums.height),
                             static_cast<int>(sums.channels));
    test::RandomSource random{seed};
    const auto below = [&](std::uint32_t n) {
        return static_cast<std::uint32_t>(random.next() * static_cast<float>(n));
    };
    for (int i = 0; i < 200; ++i)
        for (TexelBand& band : sums.bands) {
            LaneIntegers x{}, y{};
            Rgb<Packet> value;
            for (int k = 0; k < kLanes; ++k) {
                const std::uint32_t at_x = below(sums.width), at_y = below(sums.height);
                set(x, k, at_x), set(y, k, at_y);
                for (int c = 0; c < 3; ++c) set(value[c], k, random.next(-1, 1));
                for (int c = 0; c < plain.channels; ++c)
                    plain.at(static_cast<int>(at_x), static_cast<int>(at_y), c) += get(value[c], k);
            }
            add(sums, band, x, y, value);
        }
    return plain;
}

TEST(TexelSums, AreThoseOfAPlainLoop) {
    for (const int channels : {1, 3})
        for (const auto& [width, height] : {std::pair{32, 32}, {1, 1}, {70, 33}, {31, 100}}) {
            TexelSums sums = make_texel_sums(width, height, channels, 3);
            SplitGradient gradient;
            const Image& folded = gradient.first;
            const auto fold_again = [&, w = width, h = height] {
                clear(gradient, w, h, channels);
                fold(sums, gradient.first, gradient.dirty);
            };
            for (std::uint32_t seed = 50; seed < 52; ++seed) {  // empty again the second time
                const Image expected = fill(sums, seed);
                fold_again();
                ASSERT_EQ(folded.values.size(), expected.values.size());
                for (std::size_t i = 0; i < expected.values.size(); ++i)
                    EXPECT_NEAR(folded.values[i], expected.values[i], 2e-3f);
            }
            fold_again();
            for (const float v : folded.values) EXPECT_EQ(v, 0.0f);
            for (const char flag : gradient.dirty) EXPECT_EQ(flag, 0);
        }
}

/// Added one by one, a million of them would be wrong by 2 in 1000.
TEST(TexelSums, OfOneTexelHoldAMillionValues) {
    constexpr int kPackets = 1 << 16;
    for (const int channels : {1, 3}) {
        TexelSums sums = make_texel_sums(1, 1, channels, 1);
        Packet value;
        double sum = 0;
        for (int k = 0; k < kLanes; ++k) {
            set(value, k, 1.1f + 0.01f * static_cast<float>(k));
            sum += double{get(value, k)} * kPackets;
        }
        for (int i = 0; i < kPackets; ++i)
            add(sums, sums.bands[0], LaneIntegers{}, LaneIntegers{}, {value, value, value});
        SplitGradient gradient;
        clear(gradient, 1, 1, channels);
        fold(sums, gradient.first, gradient.dirty);
        for (const float v : gradient.first.values) EXPECT_NEAR(double{v} / sum, 1, 5e-5);
    }
}

TEST(TexelSums, SpreadTheDerivativeByTheLuminance) {
    TexelSums sums = make_texel_sums(70, 33, 1, 2);
    const Image expected = fill(sums, 53);
    sums.of_luminance = true;
    SplitGradient gradient;
    clear(gradient, 70, 33, out_channels(sums));
    fill(sums, 53);  // the second of two equal shares
    fold(sums, gradient.first, gradient.dirty);
    const Image& folded = gradient.first;
    ASSERT_EQ(folded.values.size(), 3 * expected.values.size());
    for (std::size_t i = 0; i < folded.values.size(); ++i)
        EXPECT_NEAR(folded.values[i], 2 * kLuminanceWeights[i % 3] * expected.values[i / 3], 4e-3f);
}

/// Each band adds its share to the tree over all, in whichever nodes it is folded.
TEST(TexelSums, NodesAddUpToTheWhole) {
    for (const bool of_luminance : {false, true}) {
        TexelSums sums = make_texel_sums(70, 33, of_luminance ? 1 : 3, 8);
        sums.of_luminance = of_luminance;
        const auto folded = [&](const IndexRange& bands) {
            SplitGradient gradient;
            clear(gradient, 70, 33, 3);
            fold(sums, bands, gradient.first, gradient.dirty);
            return gradient.first;
        };
        const auto sum = [](Image a, const Image& b) {
            for (std::size_t i = 0; i < a.values.size(); ++i) a.values[i] += b.values[i];
            return a;
        };
        fill(sums, 54);
        const Image whole = folded({0, 8});
        fill(sums, 54);
        const Image second = folded({4, 8}), third = folded({2, 4});
        EXPECT_EQ(sum(sum(folded({0, 2}), third), second), whole);
        EXPECT_NE(whole, second);
    }
}

}  // namespace
}  // namespace burnish
