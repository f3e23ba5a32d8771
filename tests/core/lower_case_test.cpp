// Letters of ASCII.
#include "core/lower_case.h"

#include <gtest/gtest.h>

namespace burnish {
namespace {

// Without the C library, whose letters follow the locale.
static_assert(lower_case('I') == 'i' && upper_case('i') == 'I');

TEST(LowerCase, ChangesTheLettersOfAsciiAlone) {
    const std::string upper = "ABCDEFGHIJKLMNOPQRSTUVWXYZ", lower = "abcdefghijklmnopqrstuvwxyz";
    for (int i = 0; i < 256; ++i) {
        const char c = static_cast<char>(i);
        const std::size_t in_upper = upper.find(c), in_lower = lower.find(c);
        EXPECT_EQ(lower_case(c), in_upper == std::string::npos ? c : lower[in_upper]) << i;
        EXPECT_EQ(upper_case(c), in_lower == std::string::npos ? c : upper[in_lower]) << i;
    }
}

TEST(LowerCase, OfATextIsThatOfItsBytes) {
    EXPECT_EQ(lower_case("intIOR \xC4\xB0 \xC3\x89.PNG"), "intior \xC4\xB0 \xC3\x89.png");
    EXPECT_EQ(lower_case(""), "");
}

}  // namespace
}  // namespace burnish
