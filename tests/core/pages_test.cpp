#include "core/pages.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>

namespace burnish {
namespace {

/// As without it: the values stay, and new ones are zero.
TEST(Pages, ReservedVectorsAreTheSame) {
    std::vector<std::uint32_t> values(1000), expected;
    std::iota(values.begin(), values.end(), 1u);
    expected = values;
    constexpr std::size_t kCount = (std::size_t{9} << 20) / sizeof(std::uint32_t) + 7;
    expected.resize(kCount);
    reserve_pages(kCount, values);
    EXPECT_EQ(values.size(), 1000u);
    EXPECT_GE(values.capacity(), kCount);
    const std::uint32_t* const memory = values.data();
    values.resize(kCount);
    EXPECT_EQ(values.data(), memory);
    EXPECT_EQ(values, expected);
}

/// To the last byte, and no further.
TEST(Pages, AllOfThemAreWritten) {
    constexpr std::size_t kPage = 4096;
    for (const std::size_t bytes : {600 * kPage, 600 * kPage + 1, 1025 * kPage - 1}) {
        std::vector<char> memory(bytes + 2 * kPage, 1);
        touch_pages(memory.data() + kPage, bytes);
        std::size_t touched = 0;
        for (std::size_t i = 0; i < memory.size(); ++i) touched += memory[i] == 0;
        EXPECT_EQ(touched, (bytes + kPage - 1) / kPage);
        for (std::size_t i = 0; i < kPage; ++i) {
            EXPECT_EQ(memory[i], 1);
            EXPECT_EQ(memory[kPage + bytes + i], 1);
        }
    }
}

}  // namespace
}  // namespace burnish
