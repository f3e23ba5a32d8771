#include "burnish/render/render.h"

#include <algorithm>
#include <atomic>
#include <mutex>

#include "burnish/core/parallel.h"
#include "burnish/render/film.h"

namespace burnish {

namespace {

constexpr int kTile = 16;  // kTile^2 samples are one batch
constexpr int kBlock = 4;  // kBlock^2 neighbouring pixels share a ray packet
static_assert(kTile * kTile == kBatchSamples);

struct Tile {
    int x0 = 0, y0 = 0, width = 0, height = 0;
};

/// The pixels of a tile in blocks of 4 x 4, so that a packet's primary rays stay together.
std::vector<std::uint32_t> tile_pixels(const Tile& tile, int film_width) {
    std::vector<std::uint32_t> pixels;
    for (int by = 0; by < tile.height; by += kBlock)
        for (int bx = 0; bx < tile.width; bx += kBlock)
            for (int y = by; y < std::min(by + kBlock, tile.height); ++y)
                for (int x = bx; x < std::min(bx + kBlock, tile.width); ++x)
                    pixels.push_back(
                        static_cast<std::uint32_t>((tile.y0 + y) * film_width + tile.x0 + x));
    return pixels;
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

TileResult render_tile(const TraceInput& input, const Tile& tile, const Film& film,
                       std::uint32_t iteration, std::uint32_t first_pass,
                       std::span<const std::array<FilterTaps, 2>> taps) {
    const int halo = taps[0][0].halo, wide = tile.width + 2 * halo;
    TileResult result;
    result.sum.assign(static_cast<std::size_t>(wide * (tile.height + 2 * halo)), Rgbf{});
    const std::vector<std::uint32_t> pixels = tile_pixels(tile, film.crop_width);
    std::vector<BatchSample> samples(pixels.size());
    std::vector<Rgbf> pass(pixels.size()), rows;
    BatchOutput out;
    for (std::uint32_t p = 0; p < taps.size(); ++p) {
        for (std::size_t i = 0; i < pixels.size(); ++i)
            samples[i].camera = {pixels[i], iteration, first_pass + p};
        trace_batch(input, samples, out);
        for (const Draw& draw : out.draws)
            out.emitted[static_cast<std::size_t>(draw.sample)] += draw.value;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const int x = static_cast<int>(pixels[i]) % film.crop_width - tile.x0;
            const int y = static_cast<int>(pixels[i]) / film.crop_width - tile.y0;
            pass[static_cast<std::size_t>(y * tile.width + x)] = out.emitted[i];
        }
        splat_pass(tile, pass, taps[p][0], taps[p][1], rows, result.sum);
        result.rejected += out.rejected;
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
        results[i] = render_tile(input, tiles[i], film, iteration, first_pass, taps.taps);
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
