#include "optimize/search_choice.h"

#include <algorithm>
#include <cmath>

namespace burnish {

namespace {

/// A candidate's loss with its best colour.
struct BestColor {
    double loss = 0;
    std::array<float, 3> color{0.5f, 0.5f, 0.5f};
};

BestColor best_color(const ColorSums& s, bool has_color) {
    BestColor best;
    for (std::size_t c = 0; c < 3; ++c) {
        double color = 0;
        if (has_color) {
            color = s.bb[c] > 0 ? std::clamp(-s.br[c] / s.bb[c], 0.0, 1.0) : 0.5;
            best.color[c] = static_cast<float>(color);
        }
        best.loss += s.rr[c] + 2 * color * s.br[c] + color * color * s.bb[c];
    }
    return best;
}

/// The channels of one unknown that reads all three alike.
ColorSums gray_sums(const ColorSums& s) {
    ColorSums gray = s;
    gray.bb.fill(s.bb[0] + s.bb[1] + s.bb[2]), gray.br.fill(s.br[0] + s.br[1] + s.br[2]);
    return gray;
}

/// The costs of candidates in a region. With a colour: what ratios of its loss count, not
/// differences, since the loss that no candidate takes away differs from region to region.
std::vector<float> make_costs(const GroupSearch& s) {
    std::vector<float> costs(s.regions() * s.candidates(), 0.0f);
    for (std::size_t r = 0; r < s.regions(); ++r) {
        if (!s.is_known(r)) continue;
        const std::size_t first = r * s.candidates();
        const std::span<float> own(&costs[first], s.candidates());
        for (std::size_t k = 0; k < own.size(); ++k) {
            double cost = 0;
            if (s.group.has_color) {
                const double loss = best_color(s.at(r, k), true).loss / s.sums.squares[r];
                cost = std::log(std::max(0.0, loss) + kNoLoss);
            } else {
                cost = s.sums.costs[first + k];
            }
            own[k] = static_cast<float>(cost);
        }
        const float least = *std::min_element(own.begin(), own.end());
        for (float& cost : own) cost -= least;
    }
    return costs;
}

/// The cost of a tenth of a grid between neighbours.
float step_of(const SearchGroup& group) { return group.has_color ? 0.5f : 1.5f; }

/// How unlike two candidates are, as costs: in steps of a tenth of each member's grid, up to a
/// limit. Less with a colour, whose costs do not grow with the squares that see a region.
std::vector<float> make_distances(const SearchGroup& group) {
    const float step = step_of(group), most = group.has_color ? 3 : 6;
    std::vector<std::vector<float>> places(group.candidates.size());
    for (std::size_t m = 0; m < group.members.size(); ++m) {
        std::vector<float> grid;
        for (const auto& c : group.candidates) grid.push_back(c[m]);
        std::sort(grid.begin(), grid.end());
        grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
        const float tenths = grid.size() == 1 ? 0 : 10 / static_cast<float>(grid.size());
        for (std::size_t k = 0; k < places.size(); ++k) {
            const auto at = std::lower_bound(grid.begin(), grid.end(), group.candidates[k][m]);
            places[k].push_back(tenths * static_cast<float>(at - grid.begin()));
        }
    }
    std::vector<float> distances;
    for (const auto& a : places)
        for (const auto& b : places) {
            float sum = 0;
            for (std::size_t m = 0; m < a.size(); ++m) sum += std::abs(a[m] - b[m]);
            distances.push_back(step * std::min(sum, most));
        }
    return distances;
}

/// The colour of a region; where its own squares say little, that of those around it.
std::array<float, 3> region_color(const GroupSearch& s, std::uint32_t region,
                                  const std::vector<std::uint32_t>& labels, bool gray) {
    constexpr double kShare = 0.1;
    ColorSums sums = s.at(region, labels[region]);
    for (const std::uint32_t n : neighbours(s.group.regions, region))
        if (s.is_known(n)) sums += s.at(n, labels[n]) * kShare;
    return best_color(gray ? gray_sums(sums) : sums, true).color;
}

/// A channel of a member in each region.
std::vector<float> region_values(const GroupSearch& s, const std::vector<std::uint32_t>& labels,
                                 std::size_t member, std::size_t channel, bool gray) {
    std::vector<char> known(s.regions());
    std::vector<float> values(s.regions());
    for (std::uint32_t r = 0; r < s.regions(); ++r) {
        known[r] = s.is_known(r);
        if (!known[r]) continue;
        values[r] = s.plan.colors[s.group.members[member]]
                        ? region_color(s, r, labels, gray)[channel]
                        : s.group.candidates[labels[r]][member];
    }
    fill_regions(s.group.regions, std::move(known), 0.5f, values);
    return values;
}

/// The texture coordinate of a texel's centre.
Vec2f uv_of(const Bitmap& bitmap, int x, int y) {
    const auto& m = bitmap.to_uv.m;
    const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(bitmap.width) - m[2];
    const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(bitmap.height) - m[5];
    const float det = m[0] * m[4] - m[1] * m[3];
    return {(m[4] * u - m[1] * v) / det, (m[0] * v - m[3] * u) / det};
}

/// The region that lies where a texel of a member is.
std::uint32_t region_of(const GroupSearch& s, const Bitmap& first, const Bitmap& bitmap, int x,
                        int y) {
    if (&first == &bitmap)
        return s.group.regions.of_texel[static_cast<std::size_t>(y * first.width + x)];
    const TexelFootprint foot = footprint(first, uv_of(bitmap, x, y));
    return s.group.regions.of_texel[foot.texel[0]];
}

}  // namespace

std::vector<std::uint32_t> choose_labels(const GroupSearch& s) {
    std::vector<char> known;
    for (std::size_t r = 0; r < s.regions(); ++r) known.push_back(s.is_known(r));
    return label_regions(s.group.regions, known, make_costs(s), make_distances(s.group));
}

std::vector<std::uint32_t> choose_again(const GroupSearch& s, const GroupSearch& earlier,
                                        const std::vector<std::uint32_t>& before) {
    const std::vector<float> distances = make_distances(s.group);
    std::vector<std::uint32_t> labels = choose_labels(s);
    for (std::uint32_t r = 0; r < labels.size(); ++r)
        if (earlier.is_known(r) &&
            distances[labels[r] * s.candidates() + before[r]] <= step_of(s.group))
            labels[r] = before[r];
    return labels;
}

Image make_start(const GroupSearch& s, const std::vector<std::uint32_t>& labels, const Scene& scene,
                 std::size_t member) {
    const auto bitmap_of_member = [&](std::size_t m) -> const Bitmap& {
        return std::get<Bitmap>(scene[s.plan.unknowns[s.group.members[m]]]);
    };
    const Bitmap &first = bitmap_of_member(0), &bitmap = bitmap_of_member(member);
    Image start = make_image(bitmap.width, bitmap.height, bitmap.channels, 0.5f);
    for (int c = 0; c < bitmap.channels; ++c) {
        const auto values =
            region_values(s, labels, member, static_cast<std::size_t>(c), bitmap.channels == 1);
        for (int y = 0; y < bitmap.height; ++y)
            for (int x = 0; x < bitmap.width; ++x)
                if (const std::uint32_t r = region_of(s, first, bitmap, x, y);
                    r != TextureRegions::kNone)
                    start.at(x, y, c) = values[r];
    }
    return start;
}

SearchedGroup describe(const GroupSearch& s, const std::vector<std::uint32_t>& labels) {
    SearchedGroup group{s.group.members, {}};
    double squares = 0;
    for (const double q : s.sums.squares) squares += q;
    for (std::size_t k = 0; k < s.candidates(); ++k) {
        SearchedValues tried{s.group.candidates[k], 0, 0};
        for (std::size_t r = 0; r < s.regions(); ++r) {
            tried.loss += best_color(s.at(r, k), s.group.has_color).loss;
            tried.regions += s.is_known(r) && labels[r] == k;
        }
        tried.loss /= std::max(1.0, 3 * squares);
        group.tried.push_back(std::move(tried));
    }
    return group;
}

}  // namespace burnish
