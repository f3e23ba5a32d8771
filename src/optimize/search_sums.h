// What the regions of textures lose at each candidate: sums over the squares of pixels of a view.
//
// The residual of one half of the samples times that of the other, independent one is without noise
// on average. A square's product is shared out among the regions that its samples met.
//
// The products are heavy-tailed: few squares see a lamp in the one half and not in the other, and
// they would decide for all that share a region with them. The cost of a square is therefore
// log(loss + kNoLoss), as of residuals with Cauchy's distribution.
//
// The picture is affine in a colour: with the colour c it is a + c b. The colour of a region at a
// candidate is the ratio of sums of t - a and of b, t the target: without products, and found from
// samples of its own before those that tell what it loses.
#pragma once

#include "optimize/search_view.h"

namespace burnish {

/// Weighted sums over squares, for each channel.
struct ColorSums {
    std::array<double, 3> target{};  ///< t - a
    std::array<double, 3> slope{};   ///< b
};
ColorSums& operator+=(ColorSums& to, const ColorSums& from);
ColorSums operator*(const ColorSums& sums, double factor);
/// Their ratio, in [0, 1]; 0.5 where they say nothing. gray: of one number for all channels.
std::array<float, 3> color_of(const ColorSums& sums, bool gray);

/// The loss of a square that is as good as none.
inline constexpr double kNoLoss = 0.01;

/// Of the regions of a group.
struct GroupSums {
    std::vector<double> squares;    ///< [regions]: how many see it, shares added up
    std::vector<double> losses;     ///< [regions, candidates]: without noise on average
    std::vector<double> costs;      ///< [regions, candidates]: log(loss + kNoLoss) of the squares
    std::vector<ColorSums> colors;  ///< [regions, candidates]; empty without a colour
};

GroupSums make_sums(const SearchGroup& group);

/// What was searched in one group. Views into a plan and the sums of a search, which must outlive
/// it.
struct GroupSearch {
    const SearchPlan& plan;
    const SearchGroup& group;
    const GroupSums& sums;

    std::size_t candidates() const { return group.candidates.size(); }
    std::size_t regions() const { return group.regions.regions.size(); }
    const ColorSums& color_at(std::size_t region, std::size_t candidate) const {
        return sums.colors[region * candidates() + candidate];
    }
    /// Whether enough squares see the region.
    bool is_known(std::size_t region) const { return sums.squares[region] >= 0.5; }
};

/// A colour for each region and candidate, [regions, candidates].
using GroupColors = std::vector<std::array<float, 3>>;

/// Adds what views say of colours, and nothing else. frames: of one plan. sums: parallel to
/// SearchPlan::groups. progress: hears of the share that is done. The same for any number of
/// threads.
void add_colors(std::span<const SearchFrame> frames, std::vector<GroupSums>& sums,
                const Progress& progress);
/// Adds what views say. colors: parallel to SearchPlan::groups, empty without a colour; of a group
/// whose colours are missing it adds nothing. The same for any number of threads.
void add_views(std::span<const SearchFrame> frames, std::span<const GroupColors> colors,
               std::vector<GroupSums>& sums, const Progress& progress = {});

}  // namespace burnish
