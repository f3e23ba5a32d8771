#include "optimize/search_choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "optimize/search_guide.h"
#include "optimize/search_uniform.h"
#include "shading/texture.h"

namespace burnish {

namespace {

/// The costs of candidates in a region.
std::vector<float> make_costs(const GroupSearch& s) {
    std::vector<float> costs(s.regions() * s.candidates(), 0.0f);
    for (std::size_t r = 0; r < s.regions(); ++r) {
        if (!s.is_known(r)) continue;
        const std::size_t first = r * s.candidates();
        const std::span<float> own(&costs[first], s.candidates());
        for (std::size_t k = 0; k < own.size(); ++k)
            own[k] = static_cast<float>(s.sums.costs[first + k]) + s.group.prior_costs[k];
        const float min = *std::min_element(own.begin(), own.end());
        for (float& cost : own) cost -= min;
    }
    return costs;
}

/// The cost of a tenth of a grid between neighbours.
constexpr float kStep = 1.5f;

std::vector<float> grid_of(const SearchGroup& group, std::size_t member) {
    std::vector<float> grid;
    for (const auto& c : group.candidates) grid.push_back(c[member]);
    std::sort(grid.begin(), grid.end());
    grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
    return grid;
}

/// How unlike two candidates are, as costs: in steps of a tenth of each member's grid, up to a
/// limit.
std::vector<float> make_distances(const SearchGroup& group) {
    constexpr float kMax = 6;
    std::vector<std::vector<float>> places(group.candidates.size());
    for (std::size_t m = 0; m < group.members.size(); ++m) {
        const std::vector<float> grid = grid_of(group, m);
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
            distances.push_back(kStep * std::min(sum, kMax));
        }
    return distances;
}

/// The colour of a region; where its own squares say little, that of those around it.
std::array<float, 3> region_color(const GroupSearch& s, std::uint32_t region,
                                  const std::vector<std::uint32_t>& labels) {
    constexpr double kShare = 0.1;
    ColorSums sums = s.color_at(region, labels[region]);
    for (const std::uint32_t n : neighbours(s.group.regions, region))
        if (s.is_known(n)) sums += s.color_at(n, labels[n]) * kShare;
    return color_of(sums, s.group.gray);
}

/// A channel of a member in each region; of those that are not known nothing.
std::vector<float> region_values(const GroupSearch& s, const std::vector<std::uint32_t>& labels,
                                 std::size_t member, std::size_t channel) {
    std::vector<float> values(s.regions());
    for (std::uint32_t r = 0; r < s.regions(); ++r) {
        if (!s.is_known(r)) continue;
        if (!s.plan.colors[s.group.members[member]])
            values[r] = s.group.candidates[labels[r]][member];
        else
            values[r] = member == s.group.color ? region_color(s, r, labels)[channel] : 0.5f;
    }
    return values;
}

/// The texel of the first member that lies where one of `bitmap` is.
std::size_t texel_of_first(const Bitmap& first, const Bitmap& bitmap, int x, int y) {
    if (&first == &bitmap)
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(first.width) +
               static_cast<std::size_t>(x);
    return main_texel(footprint(first, uv_of_texel(bitmap, x, y)));
}

std::vector<char> known_regions(const GroupSearch& s) {
    std::vector<char> known;
    for (std::size_t r = 0; r < s.regions(); ++r) known.push_back(s.is_known(r));
    return known;
}

/// What each region would have alone.
std::vector<std::uint32_t> cheapest_labels(const GroupSearch& s, const std::vector<float>& costs) {
    std::vector<std::uint32_t> labels;
    for (auto own = costs.begin(); own != costs.end();) {
        const auto end = own + static_cast<std::ptrdiff_t>(s.candidates());
        labels.push_back(static_cast<std::uint32_t>(std::min_element(own, end) - own));
        own = end;
    }
    return labels;
}

const Bitmap& bitmap_of_member(const GroupSearch& s, const Scene& scene, std::size_t member) {
    return std::get<Bitmap>(scene[s.plan.unknowns[s.group.members[member]]]);
}

/// The distance within which the nearest value of a grid lies.
float half_step(const std::vector<float>& grid, float value) {
    float nearest = 1;
    for (const float v : grid)
        if (v != value) nearest = std::min(nearest, std::abs(v - value));
    return nearest / 2;
}

/// How far regions lie from what their guides say, where that is more than the candidates resolve;
/// where nothing is known, as far as those around them.
std::vector<float> differences(const GroupSearch& s, std::size_t member,
                               const std::vector<char>& known, const GuideFit& fit,
                               std::vector<float> values) {
    const std::vector<float> grid = grid_of(s.group, member);
    for (std::size_t r = 0; r < values.size(); ++r) {
        const float d = values[r] - fit.region_values[r], tolerance = half_step(grid, values[r]);
        values[r] = known[r] ? std::copysign(std::max(0.0f, std::abs(d) - tolerance), d) : 0.0f;
    }
    fill_regions(s.group.regions, known, 0, values);
    return values;
}

/// What the values of a start follow from, in all channels of a member.
struct StartInput {
    std::vector<char> known;
    GuideLeaves leaves;  ///< of nothing where guides tell no texels apart

    bool is_guided() const { return !leaves.of_texel.empty(); }
};

StartInput start_input(const GroupSearch& s, const std::vector<std::uint32_t>& labels,
                       const Scene& scene) {
    StartInput input{known_regions(s), {}};
    if (s.group.guides.empty()) return input;
    const GuideTree tree = grow_tree(s.group, input.known, labels);
    if (tree.leaves > 1)
        input.leaves = find_leaves(s.group, tree, scene, bitmap_of_member(s, scene, 0));
    return input;
}

/// Of a channel: the values of regions, or guided what is added to those of leaves.
struct ChannelStart {
    std::vector<float> regions, leaves;

    float at(std::uint32_t region, std::size_t leaf) const {
        if (leaves.empty()) return regions[region];
        return std::clamp(regions[region] + leaves[leaf], 0.0f, 1.0f);
    }
};

ChannelStart start_channel(const GroupSearch& s, const StartInput& input, std::size_t member,
                           std::vector<float> values) {
    if (!input.is_guided()) {
        fill_regions(s.group.regions, input.known, 0.5f, values);
        return {std::move(values), {}};
    }
    GuideFit fit = fit_guide(input.leaves, input.known, values);
    return {differences(s, member, input.known, fit, std::move(values)), std::move(fit.values)};
}

/// f(region, texel of the first member, x, y) for the texels of a member that lie in a region.
void for_texels_in_regions(const GroupSearch& s, const Scene& scene, std::size_t member,
                           const auto& f) {
    const Bitmap &first = bitmap_of_member(s, scene, 0),
                 &bitmap = bitmap_of_member(s, scene, member);
    for (int y = 0; y < bitmap.height; ++y)
        for (int x = 0; x < bitmap.width; ++x) {
            const std::size_t texel = texel_of_first(first, bitmap, x, y);
            const std::uint32_t region = s.group.regions.of_texel[texel];
            if (region != TextureRegions::kNone) f(region, texel, x, y);
        }
}

Image make_start(const GroupSearch& s, const StartInput& input,
                 const std::vector<std::uint32_t>& labels, const Scene& scene, std::size_t member) {
    const Bitmap& bitmap = bitmap_of_member(s, scene, member);
    Image start = make_image(bitmap.width, bitmap.height, bitmap.channels, 0.5f);
    for (int c = 0; c < bitmap.channels; ++c) {
        if (s.group.uniform[member]) {
            start.at(0, 0, c) = uniform_value(s, labels, member, static_cast<std::size_t>(c));
            continue;
        }
        const ChannelStart channel = start_channel(
            s, input, member, region_values(s, labels, member, static_cast<std::size_t>(c)));
        for_texels_in_regions(
            s, scene, member, [&](std::uint32_t region, std::size_t texel, int x, int y) {
                start.at(x, y, c) =
                    channel.at(region, input.is_guided() ? input.leaves.of_texel[texel] : 0);
            });
    }
    return start;
}

/// The candidate of each region.
std::vector<std::uint32_t> choose_labels(const GroupSearch& s) {
    constexpr int kShareRounds = 3;
    const std::vector<char> known = known_regions(s);
    std::vector<float> costs = make_costs(s);
    fix_uniform(s, costs);
    std::vector<std::uint32_t> leaves;
    if (!s.group.guides.empty()) {
        leaves = leaves_of_regions(s.group, grow_tree(s.group, known, cheapest_labels(s, costs)));
        add_guide_costs(s.group, leaves, known, costs);
    }
    const std::vector<float> distances = make_distances(s.group);
    const auto label = [&](const std::vector<float>& all) {
        return label_regions(s.group.regions, known, all, distances, leaves);
    };
    std::vector<std::uint32_t> labels = label(costs);
    if (s.group.guides.empty() && s.group.members.size() > 1)
        for (int round = 0; round < kShareRounds; ++round)
            labels = label(with_share_costs(known, labels, s.candidates(), costs));
    return labels;
}

std::vector<Image> make_starts(const GroupSearch& s, const std::vector<std::uint32_t>& labels,
                               const Scene& scene) {
    const StartInput input = start_input(s, labels, scene);
    std::vector<Image> starts;
    for (std::size_t m = 0; m < s.group.members.size(); ++m)
        starts.push_back(make_start(s, input, labels, scene, m));
    return starts;
}

}  // namespace

GroupColors choose_colors(const GroupSearch& s) {
    if (!s.group.color) return {};
    GroupColors colors(s.sums.colors.size());
    parallel_for(s.regions(), [&](std::size_t r) {
        const auto around = neighbours(s.group.regions, static_cast<std::uint32_t>(r));
        for (std::size_t k = 0; k < s.candidates(); ++k) {
            ColorSums sums = s.color_at(r, k);
            for (const std::uint32_t n : around) sums += s.color_at(n, k);
            colors[r * s.candidates() + k] = color_of(sums, s.group.gray);
        }
    });
    return colors;
}

std::vector<float> with_share_costs(const std::vector<char>& known,
                                    const std::vector<std::uint32_t>& labels,
                                    std::size_t candidates, std::vector<float> costs) {
    std::vector<double> count(candidates, 1 / static_cast<double>(candidates));
    double all = 1;
    for (std::size_t r = 0; r < known.size(); ++r)
        if (known[r]) ++count[labels[r]], ++all;
    for (std::size_t i = 0; i < costs.size(); ++i)
        costs[i] -= static_cast<float>(std::log(count[i % candidates] / all));
    return costs;
}

GroupChoice choose(const GroupSearch& search, const Scene& scene) {
    std::vector<std::uint32_t> labels = choose_labels(search);
    std::vector<Image> starts = make_starts(search, labels, scene);
    return {search, std::move(labels), std::move(starts)};
}

GroupChoice choose_again(const GroupSearch& search, const GroupChoice& earlier,
                         const Scene& scene) {
    const std::vector<float> distances = make_distances(search.group);
    const std::vector<std::uint32_t>& before = earlier.labels;
    std::vector<std::uint32_t> labels = choose_labels(search);
    for (std::uint32_t r = 0; r < labels.size(); ++r)
        if (earlier.search.is_known(r) &&
            distances[labels[r] * search.candidates() + before[r]] <= kStep)
            labels[r] = before[r];
    std::vector<Image> starts = make_starts(search, labels, scene);
    for (std::size_t m = 0; m < starts.size(); ++m) {
        const auto keep = [&](std::uint32_t region, std::size_t, int x, int y) {
            const bool becomes_known = search.is_known(region) && !earlier.search.is_known(region);
            if (labels[region] != before[region] || becomes_known) return;
            for (int c = 0; c < starts[m].channels; ++c)
                starts[m].at(x, y, c) = earlier.starts[m].at(x, y, c);
        };
        for_texels_in_regions(search, scene, m, keep);
    }
    return {search, std::move(labels), std::move(starts)};
}

SearchedGroup describe(const GroupChoice& choice) {
    const GroupSearch& s = choice.search;
    SearchedGroup group{s.group.members, {}, {}};
    double squares = 0;
    for (const double q : s.sums.squares) squares += q;
    for (std::size_t k = 0; k < s.candidates(); ++k) {
        SearchedValues tried{s.group.candidates[k], 0, 0};
        for (std::size_t r = 0; r < s.regions(); ++r) {
            tried.loss += s.sums.losses[r * s.candidates() + k];
            tried.regions += s.is_known(r) && choice.labels[r] == k;
        }
        tried.loss /= std::max(1.0, 3 * squares);
        group.tried.push_back(std::move(tried));
    }
    return group;
}

}  // namespace burnish
