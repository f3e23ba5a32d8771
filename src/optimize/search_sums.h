// What the regions of textures lose at each candidate: sums over the squares of pixels of a view.
//
// The residual of one half of the samples times that of the other, independent one is without noise
// on average. A square's product is shared out among the regions that its samples met.
//
// The products are heavy-tailed: few squares see a lamp in the one half and not in the other, and
// they would decide for all that share a region with them. Where a candidate says all about a
// square, its cost is therefore log(loss + kNoLoss), as of residuals with Cauchy's distribution.
#pragma once

#include <functional>

#include "optimize/search_view.h"

namespace burnish {

/// Weighted sums over squares, for each channel. The picture is taken to be affine in a colour c:
/// the residual is r + c b. Primes are the other half's.
struct ColorSums {
    std::array<double, 3> rr{};  ///< r r'
    std::array<double, 3> bb{};  ///< b b'
    std::array<double, 3> br{};  ///< (b r' + b' r) / 2

    friend bool operator==(const ColorSums&, const ColorSums&) = default;
};
ColorSums& operator+=(ColorSums& to, const ColorSums& from);
ColorSums operator*(const ColorSums& sums, double factor);

/// The loss of a square that is as good as none.
inline constexpr double kNoLoss = 0.01;

/// Of the regions of a group. Without a colour b is 0.
struct GroupSums {
    std::vector<double> squares;  ///< [regions]: how many see it, shares added up
    std::vector<ColorSums> sums;  ///< [regions, candidates]
    /// [regions, candidates]: log(loss + kNoLoss) of the squares, weighted with their shares; empty
    /// with a colour, which follows from sums alone.
    std::vector<double> costs;
};

GroupSums make_sums(const SearchGroup& group);

/// Adds what a view says. sums: parallel to SearchPlan::groups. The same for any number of threads.
void add_view(const SearchFrame& frame, std::vector<GroupSums>& sums);

}  // namespace burnish
