#include "burnish/render/pass_convolution.h"

#include <algorithm>
#include <functional>

namespace burnish {

namespace {

std::size_t floats(int pixels) { return 3 * static_cast<std::size_t>(pixels); }

using TapRows = std::array<const float*, kMaxTaps>;

/// to[i] += sum_k from[k][i] weight[k], in order of k.
template <int N>
void accumulate(const TapRows& from, const float* weight, std::size_t count, float* to) {
    for (std::size_t i = 0; i < count; ++i) {
        float sum = to[i];
        for (std::size_t k = 0; k < N; ++k) sum += from[k][i] * weight[k];
        to[i] = sum;
    }
}

/// The usual filters have a loop of their own.
void accumulate(const TapRows& from, int taps, const float* weight, std::size_t count, float* to) {
    switch (taps) {
        case 1:
            return accumulate<1>(from, weight, count, to);
        case 3:
            return accumulate<3>(from, weight, count, to);
        case 4:
            return accumulate<4>(from, weight, count, to);
        case 5:
            return accumulate<5>(from, weight, count, to);
        default:
            for (int k = 0; k < taps; ++k)
                accumulate<1>({from[static_cast<std::size_t>(k)]}, weight + k, count, to);
    }
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

void splat_pass(const Tile& tile, const std::array<FilterTaps, 2>& taps, const float* pass,
                std::vector<float>& scratch, float* sum) {
    // Along y first: rows of the result from rows of the pass; then every row along x, from a
    // copy with room for the filter on both sides.
    const int halo = taps[0].halo, count = 2 * halo + 1, wide = tile.width + 2 * halo;
    scratch.assign(floats(tile.width + 4 * halo), 0.0f);
    TapRows from;
    std::array<float, kMaxTaps> weight, mirrored;
    for (int k = 0; k < count; ++k)
        mirrored[static_cast<std::size_t>(k)] =
            taps[0].weight[static_cast<std::size_t>(count - 1 - k)];
    for (int y = 0; y < tile.height + 2 * halo; ++y) {
        const int first = std::max(0, y - 2 * halo), last = std::min(tile.height - 1, y);
        for (int row = first; row <= last; ++row) {
            from[static_cast<std::size_t>(row - first)] = pass + floats(row * tile.width);
            weight[static_cast<std::size_t>(row - first)] =
                taps[1].weight[static_cast<std::size_t>(y - row)];
        }
        float* row = &scratch[floats(2 * halo)];
        std::fill_n(row, floats(tile.width), 0.0f);
        accumulate(from, last - first + 1, weight.data(), floats(tile.width), row);
        for (int k = 0; k < count; ++k) from[static_cast<std::size_t>(k)] = &scratch[floats(k)];
        accumulate(from, count, mirrored.data(), floats(wide), sum + floats(y * wide));
    }
}

void gather_pass(const Tile& tile, const std::array<FilterTaps, 2>& taps, const Image& adjoint,
                 std::vector<float>& scratch, float* weights) {
    // Along y, then along x; beyond the film there is nothing.
    const int halo = taps[0].halo, count = 2 * halo + 1, wide = tile.width + 2 * halo;
    const int x0 = std::max(0, tile.x0 - halo),
              x1 = std::min(adjoint.width, tile.x0 + tile.width + halo);
    scratch.assign(floats(wide), 0.0f);
    TapRows from;
    std::fill_n(weights, floats(tile.width * tile.height), 0.0f);
    for (int y = 0; y < tile.height; ++y) {
        const int centre = tile.y0 + y;
        const int first = std::max(0, centre - halo),
                  last = std::min(adjoint.height - 1, centre + halo);
        for (int row = first; row <= last; ++row)
            from[static_cast<std::size_t>(row - first)] = &adjoint.values[adjoint.index(x0, row)];
        float* row = &scratch[floats(x0 - tile.x0 + halo)];
        std::fill_n(row, floats(x1 - x0), 0.0f);
        accumulate(from, last - first + 1,
                   &taps[1].weight[static_cast<std::size_t>(first - centre + halo)],
                   floats(x1 - x0), row);
        for (int k = 0; k < count; ++k) from[static_cast<std::size_t>(k)] = &scratch[floats(k)];
        accumulate(from, count, taps[0].weight.data(), floats(tile.width),
                   weights + floats(y * tile.width));
    }
}

void add_tile(const Tile& tile, int halo, const float* sum, Image& image) {
    const int wide = tile.width + 2 * halo;
    const int x0 = std::max(0, tile.x0 - halo),
              x1 = std::min(image.width, tile.x0 + tile.width + halo);
    for (int y = std::max(0, tile.y0 - halo);
         y < std::min(image.height, tile.y0 + tile.height + halo); ++y)
        std::transform(&image.values[image.index(x0, y)],
                       &image.values[image.index(x0, y)] + floats(x1 - x0),
                       sum + floats((y - tile.y0 + halo) * wide + x0 - tile.x0 + halo),
                       &image.values[image.index(x0, y)], std::plus<>());
}

}  // namespace burnish
