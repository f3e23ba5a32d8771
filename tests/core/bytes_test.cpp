#include "core/bytes.h"

#include <gtest/gtest.h>

namespace burnish {
namespace {

TEST(Bytes, NumbersHaveTheOrderOfTheirFile) {
    const std::string_view bytes("\x01\x80\xff\x04\x05\x06\x07\x08\x09", 9);
    EXPECT_EQ(number_at(bytes, 0, 1), 0x01u);
    EXPECT_EQ(number_at(bytes, 1, 2), 0xff80u);
    EXPECT_EQ(number_at(bytes, 1, 2, std::endian::big), 0x80ffu);
    EXPECT_EQ(number_at(bytes, 1, 8), 0x09080706'0504ff80u);
    EXPECT_EQ(number_at(bytes, 1, 8, std::endian::big), 0x80ff0405'06070809u);
}

TEST(Bytes, ANumberThatIsCutOffIsZero) {
    const std::string_view bytes("\x01\x02\x03\x04", 4);
    EXPECT_EQ(number_at(bytes, 1, 4), 0u);
    EXPECT_EQ(number_at(bytes, 4, 1), 0u);
    EXPECT_EQ(number_at(bytes, ~std::size_t{0}, 2), 0u);
    EXPECT_EQ(number_at({}, 0, 1), 0u);
    EXPECT_EQ(number_at(bytes, 0, 4), 0x04030201u);
}

}  // namespace
}  // namespace burnish
