// The sort by texels against std::stable_sort.
#include "gradient/candidate.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/random.h"

namespace burnish {
namespace {

/// Runs of random lengths, empty ones among them; q tells the candidates apart.
std::vector<std::vector<Candidate>> random_runs(std::size_t runs, std::uint32_t slots,
                                                std::uint32_t texels, std::uint32_t seed) {
    std::vector<std::vector<Candidate>> result(runs);
    float q = 0;
    for (std::uint32_t r = 0; r < runs; ++r) {
        const auto length = philox4x32({r, 0, 0, 0}, {seed, 0})[0] % 300;
        for (std::uint32_t i = 0; i < length; ++i) {
            const auto u = philox4x32({r, i, 1, 0}, {seed, 0});
            result[r].push_back({{{u[0] % slots, u[1] % texels}, q, {}}, r});
            q += 1;
        }
    }
    return result;
}

TEST(SortByTexel, IsAStableSort) {
    struct Case {
        std::size_t runs;
        std::uint32_t slots, texels;  // of one, two and three digits
    };
    for (const Case& c : {Case{0, 1, 1},
                          {1, 1, 1},
                          {3, 1, 7},
                          {200, 3, 600},
                          {150, 1, 1 << 11},
                          {150, 2, 1 << 11},
                          {150, 1, 1 << 22},
                          {100, 5, 1 << 28}}) {
        const auto runs = random_runs(c.runs, c.slots, c.texels, 17);
        std::vector<Candidate> expected;
        for (const auto& run : runs) expected.insert(expected.end(), run.begin(), run.end());
        std::stable_sort(expected.begin(), expected.end(),
                         [](const auto& a, const auto& b) { return a.d.key < b.d.key; });
        const std::vector<Candidate> sorted = sort_by_texel(runs);
        ASSERT_EQ(sorted.size(), expected.size());
        for (std::size_t i = 0; i < sorted.size(); ++i) {
            EXPECT_EQ(sorted[i].d.key, expected[i].d.key);
            EXPECT_EQ(sorted[i].d.q, expected[i].d.q);
            EXPECT_EQ(sorted[i].path, expected[i].path);
        }
    }
}

}  // namespace
}  // namespace burnish
