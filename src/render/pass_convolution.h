// A pass and the film, one tile at a time: the convolution with the reconstruction filter, and its
// transpose. All samples of a pass share their offset within the pixel, so both are separable with
// the same weights everywhere. A slow twin of the transpose is adjoint_weight in film.h.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/film.h"

namespace burnish {

/// A rectangle of pixels.
struct Tile {
    int x0 = 0, y0 = 0, width = 0, height = 0;
};

/// A pixel of the film within a tile: y * tile width + x. film_width: pixels of the image that the
/// tile is a part of.
std::uint16_t pixel_in(const Tile& tile, std::uint32_t pixel, int film_width);

/// What each of some tiles adds to an image: [height + 2 halo, width + 2 halo, 3], or nothing.
using TileImages = std::vector<std::vector<float>>;

/// The tiles of a film's crop window, at most `side` pixels on a side, row by row.
std::vector<Tile> make_tiles(const Film& film, int side);

/// Calls body(x, y), within the tile, in the order of tracing: in blocks of 4 x 4 pixels, so that
/// the rays of a packet are neighbours.
template <class Body>
void for_pixels_in_blocks(const Tile& tile, const Body& body) {
    constexpr int kBlock = 4;
    for (int by = 0; by < tile.height; by += kBlock)
        for (int bx = 0; bx < tile.width; bx += kBlock)
            for (int y = by; y < std::min(by + kBlock, tile.height); ++y)
                for (int x = bx; x < std::min(bx + kBlock, tile.width); ++x) body(x, y);
}

/// The pixels of a tile that are marked, as places in the film, in the order of tracing. marks: of
/// each pixel of the film; empty: all are.
std::vector<std::uint32_t> marked_pixels(const Tile& tile, std::span<const char> marks,
                                         int film_width);

/// Adds a pass of the tile, [height, width, 3], convolved with the filter, to `sum`, which reaches
/// the filter's halo beyond the tile: [height + 2 halo, width + 2 halo, 3]. scratch is overwritten.
void splat_pass(const Tile& tile, const std::array<FilterTaps, 2>& taps, const float* pass,
                std::vector<float>& scratch, float* sum);

/// The transpose: weights [height, width, 3] of the samples of a pass in the tile from dL/dI
/// divided by the integral of h_j [PR eq. 5].
void gather_pass(const Tile& tile, const std::array<FilterTaps, 2>& taps,
                 const Image& normalized_adjoint, std::vector<float>& scratch, float* weights);

/// Adds the tiles' sums, halo included, to the image, in the order of the tiles; an empty sum is 0.
void add_tiles(std::span<const Tile> tiles, int halo, const TileImages& sums, Image& image);

}  // namespace burnish
