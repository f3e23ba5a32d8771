#include "burnish/render/render.h"

#include <algorithm>
#include <atomic>
#include <mutex>

#include "burnish/core/parallel.h"
#include "burnish/render/film.h"

namespace burnish {

namespace {

constexpr int kTile = 16;             // pixels on a side: the unit of work of a thread
constexpr std::uint32_t kGroup = 16;  // passes that are traced together

struct Tile {
    int x0 = 0, y0 = 0, width = 0, height = 0;
};

/// A group's samples of a tile in the order of tracing: all passes of a pixel follow one another,
/// so that a packet's rays start together and meet neighbouring points; pixels go in blocks of 4
/// x 4.
struct TileSample {
    int x = 0, y = 0;        ///< within the tile
    std::uint32_t pass = 0;  ///< within the group
};

std::vector<TileSample> tile_samples(const Tile& tile, std::uint32_t passes) {
    constexpr int kBlock = 4;
    std::vector<TileSample> samples;
    samples.reserve(static_cast<std::size_t>(tile.width * tile.height) * passes);
    for (int by = 0; by < tile.height; by += kBlock)
        for (int bx = 0; bx < tile.width; bx += kBlock)
            for (int y = by; y < std::min(by + kBlock, tile.height); ++y)
                for (int x = bx; x < std::min(bx + kBlock, tile.width); ++x)
                    for (std::uint32_t pass = 0; pass < passes; ++pass)
                        samples.push_back({x, y, pass});
    return samples;
}

/// Adds a pass of the tile, convolved with the filter, to `sum`, which reaches `halo` pixels beyond
/// the tile.
void splat_pass(const Tile& tile, const std::vector<Rgbf>& pass, const FilterTaps& tx,
                const FilterTaps& ty, std::vector<Rgbf>& rows, std::vector<Rgbf>& sum) {
    const int halo = tx.halo, taps = 2 * halo + 1, wide = tile.width + 2 * halo;
    rows.assign(static_cast<std::size_t>(wide * tile.height), Rgbf{});
    for (int y = 0; y < tile.height; ++y)
        for (int k = 0; k < taps; ++k) {
            const float weight = tx.weight[static_cast<std::size_t>(k)];
            Rgbf* to = &rows[static_cast<std::size_t>(y * wide + k)];
            const Rgbf* from = &pass[static_cast<std::size_t>(y * tile.width)];
            for (int x = 0; x < tile.width; ++x) to[x] += from[x] * weight;
        }
    for (int y = 0; y < tile.height; ++y)
        for (int k = 0; k < taps; ++k) {
            const float weight = ty.weight[static_cast<std::size_t>(k)];
            Rgbf* to = &sum[static_cast<std::size_t>((y + k) * wide)];
            const Rgbf* from = &rows[static_cast<std::size_t>(y * wide)];
            for (int x = 0; x < wide; ++x) to[x] += from[x] * weight;
        }
}

struct TileResult {
    std::vector<Rgbf> sum;
    std::size_t rejected = 0;
};

/// What each sample of a group of passes brings: radiance[pass] is [height, width] of the tile.
/// Returns the number of rejected draws.
std::size_t trace_group(const TraceInput& input, const Tile& tile, std::uint32_t iteration,
                        std::uint32_t first_pass, std::span<const TileSample> order,
                        std::vector<std::vector<Rgbf>>& radiance) {
    const auto film_width = static_cast<std::uint32_t>(input.scene->scene->film.crop_width);
    std::array<BatchSample, kBatchSamples> samples;
    std::array<Rgbf, kBatchSamples> traced;
    std::size_t rejected = 0;
    for (std::size_t begin = 0; begin < order.size(); begin += kBatchSamples) {
        const auto batch =
            order.subspan(begin, std::min<std::size_t>(kBatchSamples, order.size() - begin));
        for (std::size_t i = 0; i < batch.size(); ++i)
            samples[i].camera = {static_cast<std::uint32_t>(tile.y0 + batch[i].y) * film_width +
                                     static_cast<std::uint32_t>(tile.x0 + batch[i].x),
                                 iteration, first_pass + batch[i].pass};
        rejected +=
            trace_radiance(input, {samples.data(), batch.size()}, {traced.data(), batch.size()});
        for (std::size_t i = 0; i < batch.size(); ++i) {
            const auto at = static_cast<std::size_t>(batch[i].y * tile.width + batch[i].x);
            radiance[batch[i].pass][at] = traced[i];
        }
    }
    return rejected;
}

TileResult render_tile(const TraceInput& input, const Tile& tile, std::uint32_t iteration,
                       std::uint32_t first_pass, std::span<const std::array<FilterTaps, 2>> taps) {
    const int halo = taps[0][0].halo, wide = tile.width + 2 * halo;
    TileResult result;
    result.sum.assign(static_cast<std::size_t>(wide * (tile.height + 2 * halo)), Rgbf{});
    std::vector<Rgbf> rows;
    std::vector<std::vector<Rgbf>> radiance(
        kGroup, std::vector<Rgbf>(static_cast<std::size_t>(tile.width * tile.height)));
    const auto passes = static_cast<std::uint32_t>(taps.size());
    for (std::uint32_t p = 0; p < passes; p += kGroup) {
        const std::uint32_t group = std::min(kGroup, passes - p);
        result.rejected += trace_group(input, tile, iteration, first_pass + p,
                                       tile_samples(tile, group), radiance);
        for (std::uint32_t k = 0; k < group; ++k)
            splat_pass(tile, radiance[k], taps[p + k][0], taps[p + k][1], rows, result.sum);
    }
    return result;
}

/// Adds a tile's sum, halo included, to the image.
void add_tile(const Tile& tile, const TileResult& result, int halo, Image& image) {
    const int wide = tile.width + 2 * halo;
    for (int y = std::max(0, tile.y0 - halo);
         y < std::min(image.height, tile.y0 + tile.height + halo); ++y)
        for (int x = std::max(0, tile.x0 - halo);
             x < std::min(image.width, tile.x0 + tile.width + halo); ++x) {
            const Rgbf& v = result.sum[static_cast<std::size_t>((y - tile.y0 + halo) * wide + x -
                                                                tile.x0 + halo)];
            for (int c = 0; c < 3; ++c) image.at(x, y, c) += v[c];
        }
}

std::vector<Tile> make_tiles(const Film& film) {
    std::vector<Tile> tiles;
    for (int y = 0; y < film.crop_height; y += kTile)
        for (int x = 0; x < film.crop_width; x += kTile)
            tiles.push_back({x, y, std::min(kTile, film.crop_width - x),
                             std::min(kTile, film.crop_height - y)});
    return tiles;
}

}  // namespace

Image render(const TraceInput& input, std::uint32_t iteration, std::uint32_t first_pass,
             std::uint32_t passes, RenderCounts* counts, const Progress& progress) {
    const Film& film = input.scene->scene->film;
    const std::uint32_t first = film_pass({0, iteration, first_pass}, input.passes_per_iteration);
    const PassTaps taps = pass_taps(film.filter, input.key, first, passes);
    const std::vector<Tile> tiles = make_tiles(film);
    std::vector<TileResult> results(tiles.size());
    std::size_t done = 0;
    std::mutex reporting;
    parallel_for(tiles.size(), [&](std::size_t i) {
        results[i] = render_tile(input, tiles[i], iteration, first_pass, taps.taps);
        if (!progress) return;
        const std::scoped_lock lock(reporting);
        progress(static_cast<double>(++done) / static_cast<double>(tiles.size()));
    });

    Image image = make_image(film.crop_width, film.crop_height, 3);
    for (std::size_t i = 0; i < tiles.size();
         ++i) {  // in order: the same sums for any number of threads
        add_tile(tiles[i], results[i], filter_halo(film.filter), image);
        if (counts) counts->rejected += results[i].rejected;
    }
    const FilmNormalization n = film_normalization(film);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) *= n.x[static_cast<std::size_t>(x)] *
                                     n.y[static_cast<std::size_t>(y)] / static_cast<float>(passes);
    return image;
}

}  // namespace burnish
