#include "optimize/search_guide.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "gradient/theta.h"
#include "shading/texture.h"

namespace burnish {

namespace {

std::size_t channels_of(const Scene& scene, const std::vector<TextureId>& guides) {
    std::size_t channels = 0;
    for (const TextureId id : guides) channels += is_colored(scene[id]) ? 3 : 1;
    return channels;
}

/// Whether not all texels are equal.
bool varies(const Bitmap& bitmap) {
    const auto differ = [&](const auto& texels) {
        const std::ptrdiff_t channels = bitmap.channels;
        return std::ssize(texels) > channels &&
               !std::equal(texels.begin() + channels, texels.end(), texels.begin());
    };
    return differ(bitmap.codes) || differ(bitmap.values);
}

/// Whether the centres of texels are at the same texture coordinates.
bool has_grid_of(const Texture& texture, const Bitmap& bitmap) {
    const Bitmap* own = bitmap_of(texture);
    return own && own->width == bitmap.width && own->height == bitmap.height &&
           own->to_uv.m == bitmap.to_uv.m;
}

/// What known textures are at the centres of a bitmap's texels.
class GuideReader {
  public:
    GuideReader(const Scene& scene, const std::vector<TextureId>& guides, const Bitmap& bitmap)
        : table_{scene.textures, {}}, bitmap_(bitmap) {
        for (const TextureId id : guides)
            guides_.push_back({id, has_grid_of(scene[id], bitmap) ? bitmap_of(scene[id]) : nullptr,
                               is_colored(scene[id])});
    }

    /// 0 where they are not finite.
    void operator()(std::size_t texel, int x, int y, std::span<float> values) const {
        std::size_t i = 0;
        for (const Guide& g : guides_) {
            const Rgbf color =
                g.same_grid ? texel_color(*g.same_grid, nullptr, static_cast<std::uint32_t>(texel))
                            : eval_texture(table_, g.id, uv_of_texel(bitmap_, x, y));
            values[i++] = color.x;
            if (g.is_colored) values[i++] = color.y, values[i++] = color.z;
        }
        for (float& v : values) v = std::isfinite(v) ? v : 0;
    }

  private:
    struct Guide {
        TextureId id;
        const Bitmap* same_grid;  ///< its texels are read as they are; null: by its filter
        bool is_colored;
    };
    TextureTable table_;
    const Bitmap& bitmap_;
    std::vector<Guide> guides_;
};

/// f(texel, x, y) for the texels of regions; those of one row of blocks one after another.
void for_texels(const TextureRegions& r, const auto& f) {
    const auto down = static_cast<std::size_t>((r.height + r.side - 1) / r.side);
    parallel_for(down, [&](std::size_t block) {
        const int begin = static_cast<int>(block) * r.side;
        for (int y = begin; y < std::min(begin + r.side, r.height); ++y)
            for (int x = 0; x < r.width; ++x)
                if (const auto texel =
                        static_cast<std::size_t>(y) * static_cast<std::size_t>(r.width) +
                        static_cast<std::size_t>(x);
                    r.of_texel[texel] != TextureRegions::kNone)
                    f(texel, x, y);
    });
}

/// f(texel, the guides' values) for the texels of regions, in the same order.
void for_guides(const Scene& scene, const SearchGroup& group, const Bitmap& bitmap, const auto& f) {
    const std::size_t width = channels_of(scene, group.guides);
    const GuideReader read(scene, group.guides, bitmap);
    for_texels(group.regions, [&](std::size_t texel, int x, int y) {
        std::array<float, 3 * kMaxGuides> memory;
        const std::span<float> values(memory.data(), width);
        read(texel, x, y, values);
        f(texel, values);
    });
}

std::vector<float> texels_of_regions(const TextureRegions& regions) {
    std::vector<float> count(regions.regions.size());
    for_texels(regions, [&](std::size_t texel, int, int) { ++count[regions.of_texel[texel]]; });
    return count;
}

std::vector<std::uint8_t> leaves_of_texels(const SearchGroup& group, const GuideTree& tree,
                                           const Scene& scene, const Bitmap& bitmap) {
    std::vector<std::uint8_t> leaves(group.regions.of_texel.size());
    for_guides(scene, group, bitmap, [&](std::size_t texel, std::span<const float> values) {
        leaves[texel] = static_cast<std::uint8_t>(leaf_of(tree, values));
    });
    return leaves;
}

/// The share of each leaf in each region.
Rows shares_of(const SearchGroup& group, const GuideTree& tree,
               const std::vector<std::uint8_t>& leaves) {
    const std::vector<float> count = texels_of_regions(group.regions);
    Rows shares{std::vector<float>(count.size() * tree.leaves), tree.leaves};
    for_texels(group.regions, [&](std::size_t texel, int, int) {
        const std::uint32_t r = group.regions.of_texel[texel];
        shares.values[r * tree.leaves + leaves[texel]] += 1 / count[r];
    });
    return shares;
}

/// Of the known regions of each leaf, and `mean` as one more.
std::vector<double> means_of_leaves(const std::vector<std::uint32_t>& leaves, std::size_t count,
                                    const std::vector<char>& known,
                                    const std::vector<float>& values, double mean) {
    std::vector<double> sums(count, mean), rows(count, 1);
    for (std::size_t r = 0; r < known.size(); ++r)
        if (known[r]) sums[leaves[r]] += double{values[r]}, ++rows[leaves[r]];
    for (std::size_t i = 0; i < count; ++i) sums[i] /= rows[i];
    return sums;
}

/// The mean of known ones.
double mean_of(const std::vector<char>& known, const std::vector<float>& values) {
    double sum = 0, count = 0;
    for (std::size_t r = 0; r < known.size(); ++r)
        if (known[r]) sum += double{values[r]}, ++count;
    return count > 0 ? sum / count : 0.5;
}

/// Values x of the leaves that have the least
///
///   sum over n known regions (share . x - value)^2 + n / 50 sum over leaves (x - mean of leaf)^2
///
/// by Gauss-Seidel. The second sum keeps leaves apart that have the same shares everywhere.
std::vector<float> unmix(const Rows& shares, const std::vector<std::uint32_t>& leaves,
                         const std::vector<char>& known, const std::vector<float>& values) {
    constexpr int kSweeps = 100;
    const std::size_t n = shares.width;
    const auto count = static_cast<double>(std::count(known.begin(), known.end(), 1));
    const std::vector<double> means =
        means_of_leaves(leaves, n, known, values, mean_of(known, values));
    std::vector<double> normal(n * n), right(n), x = means;
    const double weight = std::max(1.0, count / 50);
    for (std::size_t i = 0; i < n; ++i) normal[i * n + i] = weight, right[i] = weight * means[i];
    for (std::size_t r = 0; r < known.size(); ++r) {
        if (!known[r]) continue;
        const auto share = shares[r];
        for (std::size_t i = 0; i < n; ++i) {
            if (share[i] == 0) continue;
            right[i] += double{share[i]} * double{values[r]};
            for (std::size_t k = 0; k < n; ++k)
                normal[i * n + k] += double{share[i]} * double{share[k]};
        }
    }
    for (int sweep = 0; sweep < kSweeps; ++sweep)
        for (std::size_t i = 0; i < n; ++i) {
            double rest = right[i];
            for (std::size_t k = 0; k < n; ++k)
                if (k != i) rest -= normal[i * n + k] * x[k];
            x[i] = std::clamp(rest / normal[i * n + i], 0.0, 1.0);
        }
    return {x.begin(), x.end()};
}

/// The shares of candidates among the known regions of each leaf, [leaves, candidates], by
/// expectation-maximisation; as if each leaf had one region more, with all candidates alike.
std::vector<double> candidate_shares(const std::vector<std::uint32_t>& leaves,
                                     const std::vector<char>& known,
                                     const std::vector<float>& costs, std::size_t n) {
    constexpr int kRounds = 10;
    const std::size_t count = 1 + std::size_t{*std::max_element(leaves.begin(), leaves.end())};
    std::vector<double> share(count * n, 1 / static_cast<double>(n)), own(n);
    for (int round = 0; round < kRounds; ++round) {
        std::vector<double> sums(share.size(), 1 / static_cast<double>(n)), regions(count, 1);
        for (std::size_t r = 0; r < known.size(); ++r) {
            if (!known[r]) continue;
            const std::size_t first = leaves[r] * n;
            double total = 0;
            for (std::size_t k = 0; k < n; ++k)
                total += own[k] = share[first + k] * std::exp(-double{costs[r * n + k]});
            for (std::size_t k = 0; k < n; ++k) sums[first + k] += own[k] / total;
            ++regions[leaves[r]];
        }
        for (std::size_t i = 0; i < share.size(); ++i) share[i] = sums[i] / regions[i / n];
    }
    return share;
}

}  // namespace

std::vector<TextureId> guides_of(const Scene& scene, TextureId unknown,
                                 std::span<const TextureId> recovered) {
    const auto holds = [](std::span<const TextureId> ids, TextureId id) {
        return std::find(ids.begin(), ids.end(), id) != ids.end();
    };
    std::vector<TextureId> guides, group{unknown};
    for (std::size_t member = 0; member < group.size(); ++member) {  // grows within
        if (!read_as_roughness(scene, group[member])) return {};
        bool has_guide = false;
        for (std::size_t b = 0; b < scene.bsdfs.size(); ++b) {
            const auto read = textures_of(scene, BsdfId{static_cast<std::int32_t>(b)});
            if (!holds(read, group[member])) continue;
            for (const TextureId id : read) {
                const Bitmap* bitmap = bitmap_of(scene[id]);
                const bool is_recovered = holds(recovered, id);
                if (!is_recovered && (!bitmap || bitmap->is_attribute || !varies(*bitmap)))
                    continue;
                has_guide |= !is_recovered;
                std::vector<TextureId>& ids = is_recovered ? group : guides;
                if (!holds(ids, id)) ids.push_back(id);
            }
        }
        if (!has_guide) return {};
    }
    return guides;
}

Rows read_guides(const Scene& scene, const SearchGroup& group, const Bitmap& bitmap) {
    const std::size_t width = channels_of(scene, group.guides);
    const std::vector<float> count = texels_of_regions(group.regions);
    Rows means{std::vector<float>(count.size() * width), width};
    for_guides(scene, group, bitmap, [&](std::size_t texel, std::span<const float> values) {
        const std::uint32_t r = group.regions.of_texel[texel];
        for (std::size_t i = 0; i < width; ++i) means.values[r * width + i] += values[i] / count[r];
    });
    return means;
}

GuideTree grow_tree(const SearchGroup& group, const std::vector<char>& known,
                    const std::vector<std::uint32_t>& labels) {
    Rows values{{}, group.members.size()};
    for (const std::uint32_t label : labels)
        values.values.insert(values.values.end(), group.candidates[label].begin(),
                             group.candidates[label].end());
    return grow_guide_tree(group.guide_means, values, known);
}

std::vector<std::uint32_t> leaves_of_regions(const SearchGroup& group, const GuideTree& tree) {
    std::vector<std::uint32_t> leaves;
    for (std::size_t r = 0; r < group.regions.regions.size(); ++r)
        leaves.push_back(leaf_of(tree, group.guide_means[r]));
    return leaves;
}

void add_guide_costs(const SearchGroup& group, const std::vector<std::uint32_t>& leaves,
                     const std::vector<char>& known, std::vector<float>& costs) {
    const std::size_t n = group.candidates.size();
    const auto count = static_cast<double>(std::count(known.begin(), known.end(), 1));
    if (count == 0) return;
    const std::vector<double> share = candidate_shares(leaves, known, costs, n);
    std::vector<double> all(n);
    for (std::size_t r = 0; r < known.size(); ++r)
        for (std::size_t k = 0; known[r] && k < n; ++k) all[k] += share[leaves[r] * n + k] / count;
    for (std::size_t r = 0; r < known.size(); ++r)
        for (std::size_t k = 0; k < n; ++k)
            costs[r * n + k] -=
                static_cast<float>(std::log(share[leaves[r] * n + k]) - 0.5 * std::log(all[k]));
}

GuideLeaves find_leaves(const SearchGroup& group, const GuideTree& tree, const Scene& scene,
                        const Bitmap& bitmap) {
    GuideLeaves leaves{
        leaves_of_texels(group, tree, scene, bitmap), leaves_of_regions(group, tree), {}};
    leaves.shares = shares_of(group, tree, leaves.of_texel);
    return leaves;
}

GuideFit fit_guide(const GuideLeaves& leaves, const std::vector<char>& known,
                   const std::vector<float>& values) {
    const Rows& shares = leaves.shares;
    GuideFit fit{unmix(shares, leaves.of_region, known, values), {}};
    for (std::size_t r = 0; r < values.size(); ++r) {
        float mean = 0;
        for (std::size_t l = 0; l < shares.width; ++l) mean += shares[r][l] * fit.values[l];
        fit.region_values.push_back(mean);
    }
    return fit;
}

}  // namespace burnish
