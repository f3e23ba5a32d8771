// The contribution that stands out does not depend on the order of the others.
#include "gradient/outliers.h"

#include <gtest/gtest.h>

namespace burnish {
namespace {

TEST(Outliers, TheLargerStandsOutAndOfEqualOnesTheFirstByName) {
    // Slots before texels, texels before pixels, pixels before techniques.
    const Outlier descending[] = {
        {5, 9, 9, 9, Technique::kBsdf},    {4, 9, 1, 9, Technique::kBsdf},
        {4, 9, 2, 1, Technique::kBsdf},    {4, 1, 2, 2, Technique::kBsdf},
        {4, 2, 2, 2, Technique::kEmitter}, {4, 2, 2, 2, Technique::kBsdf}};
    for (std::size_t i = 0; i < std::size(descending); ++i)
        for (std::size_t j = 0; j < std::size(descending); ++j)
            EXPECT_EQ(stands_out_more(descending[i], descending[j]), i < j) << i << ", " << j;
}

TEST(Outliers, WhatIsZeroIsNone) {
    EXPECT_FALSE(stands_out_more({0, 3, 2, 1, Technique::kEmitter}, {}));
    EXPECT_TRUE(stands_out_more({1e-30f, 3, 2, 1, Technique::kEmitter}, {}));
}

}  // namespace
}  // namespace burnish
