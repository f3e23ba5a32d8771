// What a search for the start chooses: values that many regions have cost less.
#include "optimize/search_choice.h"

#include <gtest/gtest.h>

#include <cmath>

namespace burnish {
namespace {

/// Three of four known regions have the first candidate, one has the last.
TEST(SearchShares, RareCandidatesCostMore) {
    std::vector<char> known(210, 1);
    std::vector<std::uint32_t> labels(210, 1);
    for (std::size_t r = 0; r < 210; ++r)
        if (r < 200)
            labels[r] = r % 4 == 0 ? 2 : 0;
        else
            known[r] = 0;
    std::vector<float> costs(210 * 3, 0.5f);
    costs[4] = 7;
    const std::vector<float> all = with_share_costs(known, labels, 3, costs);
    const double third = 1.0 / 3;
    const double expected[] = {-std::log((150 + third) / 201), -std::log(third / 201),
                               -std::log((50 + third) / 201)};
    for (std::size_t i = 0; i < all.size(); ++i)
        EXPECT_NEAR(all[i] - costs[i], expected[i % 3], 1e-5) << i;
}

}  // namespace
}  // namespace burnish
