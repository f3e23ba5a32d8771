// The regression tree over known textures: what it splits, and what it leaves alone.
#include "texture/guide.h"

#include <gtest/gtest.h>

#include <cmath>

#include "random_source.h"

namespace burnish {
namespace {

constexpr std::size_t kRows = 4000;

/// Three columns of noise; the unknown follows the second one in three steps, with noise.
struct Steps {
    Rows known{std::vector<float>(3 * kRows), 3}, unknown{std::vector<float>(kRows), 1};
    std::vector<char> present = std::vector<char>(kRows, 1);
};

float step_at(float x) { return x < 0.3f ? 0.2f : x < 0.8f ? 0.7f : 0.4f; }

Steps make_steps(float noise, bool follow = true) {
    Steps s;
    test::RandomSource random{5};
    for (float& v : s.known.values) v = random.next(0, 1);
    for (std::size_t r = 0; r < kRows; ++r)
        s.unknown.values[r] = (follow ? step_at(s.known[r][1]) : 0.5f) + noise * random.next(-1, 1);
    return s;
}

TEST(GuideTree, FollowsTheColumnThatDecides) {
    const Steps s = make_steps(0.2f);
    const GuideTree tree = grow_guide_tree(s.known, s.unknown, s.present);
    std::vector<double> sum(tree.leaves), count(tree.leaves);
    for (std::size_t r = 0; r < kRows; ++r) {
        const std::uint32_t leaf = leaf_of(tree, s.known[r]);
        sum[leaf] += double{s.unknown.values[r]}, ++count[leaf];
    }
    EXPECT_GE(tree.leaves, 3u);
    for (const double n : count) EXPECT_GE(n, 32);
    for (const float x : {0.1f, 0.5f, 0.9f}) {
        const std::uint32_t leaf = leaf_of(tree, std::vector{0.5f, x, 0.5f});
        EXPECT_NEAR(sum[leaf] / count[leaf], step_at(x), 0.03) << x;
    }
}

/// A tree that splits wherever it gains anything has 64 leaves here: the seeded defect.
TEST(GuideTree, LeavesNoiseAlone) {
    const Steps s = make_steps(0.2f, false);
    EXPECT_EQ(grow_guide_tree(s.known, s.unknown, s.present).leaves, 1u);
}

/// What rounding leaves of their spread is nothing to be explained.
TEST(GuideTree, RowsThatAreAlikeAreOneLeaf) {
    for (const float value : {0.05f, 0.3f, 0.9f}) {
        Steps s = make_steps(0);
        std::fill(s.unknown.values.begin(), s.unknown.values.end(), value);
        for (std::size_t r = 1000; r < kRows; ++r) s.present[r] = 0;
        EXPECT_EQ(grow_guide_tree(s.known, s.unknown, s.present).leaves, 1u) << value;
    }
}

/// Texels of files have few values, so that thresholds are some of them: these lie above.
TEST(GuideTree, AValueThatIsAThresholdLiesAboveIt) {
    Rows known{std::vector<float>(400), 1}, unknown{std::vector<float>(400), 1};
    for (std::size_t r = 0; r < 400; ++r) {
        known.values[r] = r % 2 == 0 ? 0.25f : 0.75f;
        unknown.values[r] = r % 2 == 0 ? 0.1f : 0.9f;
    }
    const GuideTree tree = grow_guide_tree(known, unknown, std::vector<char>(400, 1));
    EXPECT_EQ(tree.leaves, 2u);
    EXPECT_NE(leaf_of(tree, std::vector{0.25f}), leaf_of(tree, std::vector{0.75f}));
}

TEST(GuideTree, ReadsRowsThatArePresentAlone) {
    Steps s = make_steps(0.1f);
    for (std::size_t r = 0; r < kRows; r += 2) {
        s.present[r] = 0;
        s.known.values[3 * r + 1] = NAN, s.unknown.values[r] = NAN;
    }
    const GuideTree tree = grow_guide_tree(s.known, s.unknown, s.present);
    EXPECT_NE(leaf_of(tree, std::vector{0.5f, 0.1f, 0.5f}),
              leaf_of(tree, std::vector{0.5f, 0.5f, 0.5f}));
}

TEST(GuideTree, NothingIsOneLeaf) {
    EXPECT_EQ(grow_guide_tree({{}, 2}, {{}, 1}, {}).leaves, 1u);
    const Steps s = make_steps(0.1f);
    EXPECT_EQ(grow_guide_tree(s.known, s.unknown, std::vector<char>(kRows, 0)).leaves, 1u);
    Steps same = s;
    std::fill(same.known.values.begin(), same.known.values.end(), 0.5f);
    EXPECT_EQ(grow_guide_tree(same.known, same.unknown, same.present).leaves, 1u);
}

}  // namespace
}  // namespace burnish
