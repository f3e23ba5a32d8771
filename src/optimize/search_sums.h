// What the regions of textures lose at each candidate: sums over the squares of pixels of a view.
//
// The residual of one half of the samples times that of the other, independent one is without noise
// on average. A square's product is shared out among the regions that its samples met.
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

/// Of the regions of a group. Without a colour b is 0.
struct GroupSums {
    std::vector<double> squares;  ///< [regions]: how many see it, shares added up
    std::vector<ColorSums> sums;  ///< [regions, candidates]
};

GroupSums make_sums(const SearchGroup& group);

/// Adds what a view says. sums: parallel to SearchPlan::groups. The same for any number of threads.
void add_view(const SearchFrame& frame, std::vector<GroupSums>& sums);

}  // namespace burnish
