#include "core/variant.h"

#include <gtest/gtest.h>

namespace burnish {
namespace {

struct One {};
struct Two {
    int value = 2;
};
using Kind = std::variant<One, Two>;

constexpr auto kOfOne = [](const One&) { return 1; };
constexpr auto kOfTwo = [](const Two& two) { return two.value; };

TEST(Match, CallsTheFunctionOfTheAlternative) {
    EXPECT_EQ(match(Kind(One{}), kOfOne, kOfTwo), 1);
    EXPECT_EQ(match(Kind(Two{7}), kOfOne, kOfTwo), 7);
}

TEST(Match, ReachesTheAlternativeItself) {
    Kind kind = Two{};
    match(
        kind, [](One&) {}, [](Two& two) { two.value = 5; });
    EXPECT_EQ(std::get<Two>(kind).value, 5);
}

}  // namespace
}  // namespace burnish
