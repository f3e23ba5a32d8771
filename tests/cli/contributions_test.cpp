// Contributions that stand out over many iterations.
#include "cli/contributions.h"

#include <gtest/gtest.h>

namespace burnish {
namespace {

Outlier at(std::uint32_t pixel, float value) {
    Outlier e;
    e.pixel = pixel, e.value = value;
    return e;
}

TEST(Contributions, TheLargestOfEachPlaceIsKeptOnce) {
    ContributionCounts counts;
    GradientCounts first, second;
    first.outliers = {at(1, 9), at(2, 5)};
    second.outliers = {at(2, 7), at(1, 8), at(3, 1)};
    add_counts(counts, first, 0);
    add_counts(counts, second, 1);
    ASSERT_EQ(counts.outliers.size(), 3u);
    const std::uint32_t pixels[] = {1, 2, 3}, iterations[] = {0, 1, 1};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(counts.outliers[i].contribution.pixel, pixels[i]);
        EXPECT_EQ(counts.outliers[i].iteration, iterations[i]);
    }
}

TEST(Contributions, NoMoreThanAFewAreKept) {
    ContributionCounts counts;
    GradientCounts more;
    for (std::uint32_t i = 0; i < 20; ++i) more.outliers.push_back(at(i, static_cast<float>(i)));
    add_counts(counts, more, 0);
    ASSERT_EQ(counts.outliers.size(), kMaxOutliers);
    EXPECT_EQ(counts.outliers.front().contribution.pixel, 19u);
    EXPECT_EQ(counts.outliers.back().contribution.pixel, 12u);
}

}  // namespace
}  // namespace burnish
