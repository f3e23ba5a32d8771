#include "render/pass_convolution.h"

#include <algorithm>
#include <functional>

#include "core/parallel.h"

namespace burnish {

namespace {

std::size_t floats(int pixels) { return 3 * static_cast<std::size_t>(pixels); }

using TapRows = std::array<const float*, kMaxTaps>;

/// to[i] = start + sum_k from[k][i] weight[k], in order of k; start: 0, or to[i] (kAdd).
template <bool kAdd, int N>
void weigh(const TapRows& from, const float* weight, std::size_t count, float* to) {
    for (std::size_t i = 0; i < count; ++i) {
        float sum = kAdd ? to[i] : 0.0f;
        for (std::size_t k = 0; k < N; ++k) sum += from[k][i] * weight[k];
        to[i] = sum;
    }
}

/// The usual filters have a loop of their own.
template <bool kAdd>
void weigh(const TapRows& from, int taps, const float* weight, std::size_t count, float* to) {
    switch (taps) {
        case 1:
            return weigh<kAdd, 1>(from, weight, count, to);
        case 2:
            return weigh<kAdd, 2>(from, weight, count, to);
        case 3:
            return weigh<kAdd, 3>(from, weight, count, to);
        case 4:
            return weigh<kAdd, 4>(from, weight, count, to);
        case 5:
            return weigh<kAdd, 5>(from, weight, count, to);
        default:
            if (!kAdd) std::fill_n(to, count, 0.0f);
            for (int k = 0; k < taps; ++k)
                weigh<true, 1>({from[static_cast<std::size_t>(k)]}, weight + k, count, to);
    }
}

/// The taps of an axis that are not 0: a sample reaches one pixel less on the side that it is
/// farther from.
struct TapRange {
    int begin = 0, end = 0;
};
TapRange used(const FilterTaps& taps) {
    TapRange range{0, 2 * taps.halo + 1};
    const auto zero = [&](int k) { return taps.weight[static_cast<std::size_t>(k)] == 0; };
    while (range.end - range.begin > 1 && zero(range.begin)) ++range.begin;
    while (range.end - range.begin > 1 && zero(range.end - 1)) --range.end;
    return range;
}

}  // namespace

std::vector<Tile> make_tiles(const Film& film, int side) {
    std::vector<Tile> tiles;
    for (int y = 0; y < film.crop_height; y += side)
        for (int x = 0; x < film.crop_width; x += side)
            tiles.push_back(
                {x, y, std::min(side, film.crop_width - x), std::min(side, film.crop_height - y)});
    return tiles;
}

std::uint16_t pixel_in(const Tile& tile, std::uint32_t pixel, int film_width) {
    const int x = static_cast<int>(pixel) % film_width - tile.x0;
    const int y = static_cast<int>(pixel) / film_width - tile.y0;
    return static_cast<std::uint16_t>(y * tile.width + x);
}

std::vector<std::uint32_t> marked_pixels(const Tile& tile, std::span<const char> marks,
                                         int film_width) {
    std::vector<std::uint32_t> pixels;
    for_pixels_in_blocks(tile, [&](int x, int y) {
        const auto pixel = static_cast<std::uint32_t>((tile.y0 + y) * film_width + tile.x0 + x);
        if (marks.empty() || marks[pixel]) pixels.push_back(pixel);
    });
    return pixels;
}

void splat_pass(const Tile& tile, const std::array<FilterTaps, 2>& taps, const float* pass,
                std::vector<float>& scratch, float* sum) {
    // Along y first: rows of the result from rows of the pass; then every row along x, from a
    // copy with room for the filter on both sides.
    const int halo = taps[0].halo, count = 2 * halo + 1, wide = tile.width + 2 * halo;
    const TapRange x = used(taps[0]), y = used(taps[1]);
    scratch.assign(floats(tile.width + 4 * halo), 0.0f);
    float* middle = &scratch[floats(2 * halo)];
    TapRows from_y, from_x;
    std::array<float, kMaxTaps> weight_y, weight_x;
    for (int k = x.end; k-- > x.begin;) {  // mirrored
        const auto at = static_cast<std::size_t>(x.end - 1 - k);
        from_x[at] = &scratch[floats(count - 1 - k)];
        weight_x[at] = taps[0].weight[static_cast<std::size_t>(k)];
    }
    for (int out = 0; out < tile.height + 2 * halo; ++out) {
        const int first = std::max(0, out - y.end + 1),
                  last = std::min(tile.height - 1, out - y.begin);
        if (first > last) continue;
        for (int row = first; row <= last; ++row) {
            from_y[static_cast<std::size_t>(row - first)] = pass + floats(row * tile.width);
            weight_y[static_cast<std::size_t>(row - first)] =
                taps[1].weight[static_cast<std::size_t>(out - row)];
        }
        weigh<false>(from_y, last - first + 1, weight_y.data(), floats(tile.width), middle);
        weigh<true>(from_x, x.end - x.begin, weight_x.data(), floats(wide),
                    sum + floats(out * wide));
    }
}

void gather_pass(const Tile& tile, const std::array<FilterTaps, 2>& taps, const Image& adjoint,
                 std::vector<float>& scratch, float* weights) {
    // Along y, then along x; beyond the film there is nothing.
    const int halo = taps[0].halo, wide = tile.width + 2 * halo;
    const TapRange x = used(taps[0]), y = used(taps[1]);
    const int x0 = std::max(0, tile.x0 - halo),
              x1 = std::min(adjoint.width, tile.x0 + tile.width + halo);
    scratch.assign(floats(wide), 0.0f);
    float* middle = &scratch[floats(x0 - tile.x0 + halo)];
    TapRows from_y, from_x;
    for (int k = x.begin; k < x.end; ++k)
        from_x[static_cast<std::size_t>(k - x.begin)] = &scratch[floats(k)];
    for (int out = 0; out < tile.height; ++out) {
        const int top = tile.y0 + out - halo;  // the row of tap 0
        const int first = std::max(0, top + y.begin), last = std::min(adjoint.height, top + y.end);
        for (int row = first; row < last; ++row)
            from_y[static_cast<std::size_t>(row - first)] = &adjoint.values[adjoint.index(x0, row)];
        weigh<false>(from_y, last - first, &taps[1].weight[static_cast<std::size_t>(first - top)],
                     floats(x1 - x0), middle);
        weigh<false>(from_x, x.end - x.begin, &taps[0].weight[static_cast<std::size_t>(x.begin)],
                     floats(tile.width), weights + floats(out * tile.width));
    }
}

void add_tiles(std::span<const Tile> tiles, int halo, const TileImages& sums, Image& image) {
    // In bands of rows: every pixel meets its tiles in their order, whoever works on its band.
    const auto height = static_cast<std::size_t>(image.height);
    parallel_chunks(height, 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = 0; i < tiles.size(); ++i) {
            const Tile& tile = tiles[i];
            if (sums[i].empty()) continue;
            const int wide = tile.width + 2 * halo;
            const int x0 = std::max(0, tile.x0 - halo),
                      x1 = std::min(image.width, tile.x0 + tile.width + halo);
            const int y0 = std::max(static_cast<int>(begin), tile.y0 - halo),
                      y1 = std::min(static_cast<int>(end), tile.y0 + tile.height + halo);
            for (int y = y0; y < y1; ++y) {
                float* to = &image.values[image.index(x0, y)];
                const float* from =
                    &sums[i][floats((y - tile.y0 + halo) * wide + x0 - tile.x0 + halo)];
                std::transform(to, to + floats(x1 - x0), from, to, std::plus<>());
            }
        }
    });
}

}  // namespace burnish
