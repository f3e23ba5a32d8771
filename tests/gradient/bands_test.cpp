// A view in bands: parts of a cache and of a background that different processes have make the
// bytes of the whole.
#include "gradient/bands.h"

#include <gtest/gtest.h>

#include <bit>

#include "gradient/background.h"
#include "gradient/path_cache/path_cache.h"
#include "gradient/small_scene.h"
#include "render/render.h"

namespace burnish {
namespace {

TEST(Bands, AreSharedOutInTheFewestNodes) {
    for (std::size_t begin = 0; begin <= kViewBands; ++begin)
        for (std::size_t end = begin; end <= kViewBands; ++end) {
            std::size_t at = begin;
            const std::vector<IndexRange> nodes = nodes_of({begin, end});
            for (const IndexRange& node : nodes) {
                EXPECT_EQ(node.begin, at);
                EXPECT_TRUE(std::has_single_bit(node.size()));
                EXPECT_EQ(node.begin % node.size(), 0u);
                at = node.end;
            }
            EXPECT_EQ(at, end);
            for (std::size_t i = 1; i < nodes.size(); ++i)
                EXPECT_FALSE(nodes[i].size() == nodes[i - 1].size() &&
                             nodes[i - 1].begin % (2 * nodes[i].size()) == 0)
                    << "two halves of a node";
        }
}

TEST(Bands, ShareOutTiles) {
    for (std::size_t count = 0; count < 200; ++count) {
        std::size_t at = 0, max = 0, used = 0;
        for (std::size_t b = 0; b < kViewBands; ++b) {
            const IndexRange tiles = tiles_of({b, b + 1}, count);
            EXPECT_EQ(tiles.begin, at);
            at = tiles.end, max = std::max(max, tiles.size()), used += !tiles.empty();
        }
        EXPECT_EQ(at, count);
        EXPECT_EQ(max, (count + kViewBands - 1) / kViewBands);
        EXPECT_EQ(used, max == 0 ? 0 : (count + max - 1) / max);
        const auto half = static_cast<double>(tiles_of({0, 16}, count).size());
        EXPECT_NEAR(half, 0.5 * static_cast<double>(count), static_cast<double>(max));
    }
}

/// Several tiles in each direction, and a filter that reaches into the next ones.
Scene wide_scene() {
    Scene scene = test::make_small_scene();
    scene.film = {150, 100, 0, 0, 150, 100, scene.film.filter};
    return scene;
}

/// Bands of a cache after some passes, shaded.
struct CachePart {
    PathCacheWorkspace workspace;
    PathCacheState state;
    HalfTiles tiles;

    CachePart(const PathCacheInput& input, const IndexRange& bands)
        : workspace(make_workspace(PathCache{}, input.binding, CacheUse::kImageAndGradient, bands)),
          tiles() {
        trace_passes(input, 4, workspace, state);
        tiles = shade_tiles(input, state, workspace);
    }
};

const std::vector<std::vector<std::size_t>> kSplits = {
    {0, 16, 32}, {0, 11, 32}, {0, 5, 9, 9, 31, 32}, {0, 8, 16, 24, 32}};

TEST(Bands, OfACacheMakeTheImagesOfTheWhole) {
    const Scene scene = wide_scene();
    const Theta theta = test::theta_of(scene);
    const TracedScene traced = prepare(scene);
    const Binding binding(traced, theta);
    const PathCacheInput input{binding, 5};
    CachePart whole(input, kAllBands);
    const HalfImages images = shade(input, whole.state, whole.workspace);
    ASSERT_GT(whole.workspace.tiles.size(), 10u);
    for (const std::vector<std::size_t>& split : kSplits) {
        std::array<TileImages, 2> joined{TileImages(whole.workspace.tiles.size()),
                                         TileImages(whole.workspace.tiles.size())};
        std::size_t records = 0;
        for (std::size_t p = 0; p + 1 < split.size(); ++p) {
            CachePart part(input, {split[p], split[p + 1]});
            records += size_of(part.state, part.workspace).records;
            for (std::size_t h = 0; h < 2; ++h)
                for (std::size_t i = 0; i < joined[h].size(); ++i)
                    if (!part.tiles.halves[h][i].empty()) {
                        EXPECT_TRUE(joined[h][i].empty()) << "a tile has one owner";
                        joined[h][i] = part.tiles.halves[h][i];
                    }
        }
        EXPECT_EQ(records, size_of(whole.state, whole.workspace).records);
        for (std::size_t h = 0; h < 2; ++h)
            EXPECT_EQ(half_image(scene.film, whole.state.halves[h], whole.workspace, joined[h]),
                      images.images[h]);
    }
}

/// The definition: a node is the sum of its halves.
Image tree_sum(const std::vector<Image>& leaves, std::size_t begin, std::size_t size) {
    if (size == 1) return leaves[begin];
    Image sum = tree_sum(leaves, begin, size / 2);
    const Image second = tree_sum(leaves, begin + size / 2, size / 2);
    for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += second.values[i];
    return sum;
}

TEST(Bands, AreTheLeavesOfATree) {
    Scene scene = wide_scene();
    const Theta theta = test::theta_of(scene);
    const TracedScene traced = prepare(scene);
    const Binding binding(traced, theta);
    const PathCacheInput input{binding, 5};
    const std::array<Image, 2> adjoints{test::make_adjoint(scene, 51, true),
                                        test::make_adjoint(scene, 52, true)};
    const auto gradient_of = [&](CachePart& part) -> const std::vector<BandGradient>& {
        return accumulate_bands(input, part.state, {&adjoints[0], &adjoints[1]}, part.workspace);
    };
    std::vector<std::vector<std::array<Image, 2>>> leaves;
    for (std::size_t b = 0; b < kViewBands; ++b) {
        CachePart part(input, {b, b + 1});
        const std::vector<BandGradient>& found = gradient_of(part);
        ASSERT_EQ(found.size(), 1u);
        auto& leaf = leaves.emplace_back();
        for (const SplitGradient& g : found[0].gradient) leaf.push_back({g.first, g.second});
    }
    const auto sum_of_leaves = [&](const IndexRange& node, std::size_t texture, std::size_t half) {
        std::vector<Image> images;
        for (const auto& leaf : leaves) images.push_back(leaf[texture][half]);
        return tree_sum(images, node.begin, node.size());
    };
    for (const IndexRange& bands : {kAllBands, IndexRange{5, 22}, IndexRange{0, 16}}) {
        CachePart part(input, bands);
        const std::vector<BandGradient>& found = gradient_of(part);
        EXPECT_EQ(found.size(), nodes_of(bands).size());
        for (const BandGradient& node : found)
            for (std::size_t t = 0; t < theta.textures.size(); ++t) {
                EXPECT_EQ(node.gradient[t].first, sum_of_leaves(node.bands, t, 0));
                EXPECT_EQ(node.gradient[t].second, sum_of_leaves(node.bands, t, 1));
            }
    }
}

TEST(Bands, OfABackgroundMakeTheWhole) {
    const Scene scene = wide_scene();
    const Theta theta = test::theta_of(scene);
    const TracedScene traced = prepare(scene);
    const Binding binding(traced, theta);
    const NearUnknown near = near_unknown(binding.film(), reaching_pixels(binding));
    const BackgroundOptions options{2, 6, 5};
    const std::size_t tiles = tile_count(scene.film);
    for (const std::vector<std::size_t>& split : kSplits) {
        Background whole;
        std::vector<Background> parts(split.size() - 1);
        for (std::uint32_t v = 0; v < 10; ++v) {
            const std::size_t rejected = gather_background(binding, near, options, v, whole);
            TileImages sums;
            std::size_t counted = 0;
            Background joined = parts[0];
            for (std::size_t p = 0; p < parts.size(); ++p) {
                BackgroundTiles own = trace_background(binding, near, options, v, parts[p],
                                                       items_of({split[p], split[p + 1]}, tiles));
                counted += own.rejected;
                sums.resize(own.sums.size());
                for (std::size_t i = 0; i < sums.size(); ++i)
                    if (!own.sums[i].empty()) sums[i] = std::move(own.sums[i]);
                if (p > 0) join_rows(parts[p], joined);
            }
            add_background(scene.film, near, options, v, sums, joined);
            EXPECT_EQ(joined, whole) << v;
            EXPECT_EQ(counted, rejected);
            for (std::size_t p = 0; p < parts.size(); ++p)
                parts[p] = rows_of(joined, items_of({split[p], split[p + 1]}, 100));
        }
    }
}

}  // namespace
}  // namespace burnish
