// Sums that do not depend on the order, against sums in wider numbers.
#include "core/exact_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "random_source.h"

namespace burnish {
namespace {

ExactSum sum_of(const std::vector<float>& values) {
    ExactSum sum;
    for (const float v : values) add(v, sum);
    return sum;
}

/// Sizes from 2^-60 to 2^10: sums of them in double depend on the order.
std::vector<float> values_of_all_sizes() {
    test::RandomSource random{3};
    std::vector<float> values;
    for (int i = 0; i < 10'000; ++i)
        values.push_back(random.next(0.0f, 1.0f) *
                         std::ldexp(1.0f, static_cast<int>(random.next(-60.0f, 10.0f))));
    return values;
}

TEST(ExactSum, IsTheSameInAnyOrderAndInParts) {
    std::vector<float> values = values_of_all_sizes();
    const ExactSum sum = sum_of(values);
    double forward = 0, backward = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
        forward += double{values[i]}, backward += double{values[values.size() - 1 - i]};
    ASSERT_NE(forward, backward) << "a sum that depends on the order: what is tested";
    std::reverse(values.begin(), values.end());
    EXPECT_EQ(sum_of(values).limbs, sum.limbs);
    std::reverse(values.begin(), values.end());
    for (const std::ptrdiff_t at : {1, 777, 9'000}) {
        ExactSum parts = sum_of({values.begin(), values.begin() + at});
        const ExactSum rest = sum_of({values.begin() + at, values.end()});
        for (std::size_t k = 0; k < ExactSum::kLimbs; ++k) parts.limbs[k] += rest.limbs[k];
        EXPECT_EQ(parts.limbs, sum.limbs) << at;
    }
    EXPECT_NEAR(value_of(sum) / forward, 1, 1e-12);
}

TEST(ExactSum, HoldsWhatIsInItsRange) {
    for (const float v : {0.0f, 1.0f, 1.5e-20f, 0x1p-96f, 0x1p24f, 12345.678f, 1.5e20f, 0x1p72f})
        EXPECT_EQ(value_of(sum_of({v})), double{v});
    EXPECT_EQ(value_of(sum_of({0x1p-97f})), 0);
    for (const float v : {0x1p73f, std::numeric_limits<float>::infinity()})
        EXPECT_EQ(value_of(sum_of({v})), 0x1p72);
}

}  // namespace
}  // namespace burnish
