// The samples of a tile of squares: traced once, shaded at any constant values of the unknowns.
#pragma once

#include "optimize/search_view.h"
#include "render/pass_convolution.h"

namespace burnish {

/// A tile of squares, at most as many as a batch has samples.
struct SearchTile {
    Tile tile;
    std::vector<int> squares;  ///< that may see an unknown: y * tile.width + x
};
std::vector<SearchTile> make_search_tiles(const SearchFrame& frame);
/// A tile of one of several views, which must outlive it.
struct ViewTile {
    const SearchFrame* frame;
    SearchTile tile;
};
/// View by view.
std::vector<ViewTile> make_view_tiles(std::span<const SearchFrame> frames);
/// Of a square of a tile: its number in the frame.
inline std::size_t frame_index(const SearchFrame& frame, const Tile& tile, int square) {
    return static_cast<std::size_t>((tile.y0 + square / tile.width) * frame.width + tile.x0 +
                                    square % tile.width);
}

/// One half of a tile's samples.
struct TileSamples {
    std::vector<TileRecords> records;  ///< of each pass; their pixels are the tile's squares
    std::vector<RecordMemory> memory;  ///< parallel to records
    std::vector<float> constant;       ///< [squares, 3]: sums of what no unknown changes
    std::vector<float> counts;         ///< [squares]: passes
};

/// The share of a square that is a region's.
struct RegionShare {
    std::uint32_t square = 0, region = 0;
    float weight = 0;
};

/// Views into the frame, which must outlive it.
struct TracedTile {
    const SearchFrame& frame;
    Tile tile;
    std::array<TileSamples, 2> halves;
    /// For each group the squares that see no other one, by how many of their samples met which
    /// regions; in order of squares. Those without samples in both halves or without a weight, and
    /// those that see a BSDF that tells nothing, are left out.
    std::vector<std::vector<RegionShare>> shares;
};
TracedTile trace_tile(const SearchFrame& frame, const SearchTile& tile);

/// Pictures of both halves, [squares, 3], with the unknowns of a group at a candidate. Of squares
/// that see other groups they mean nothing.
struct GroupPictures {
    std::array<std::vector<float>, 2> black;  ///< its colours at 0
    std::array<std::vector<float>, 2> white;  ///< at 1; empty without a colour
};
GroupPictures shade_group(const TracedTile& tile, std::size_t group, std::size_t candidate);

/// Both halves of a tile, all of its light under these textures: [squares, 3], NaN where no sample
/// fell.
std::array<std::vector<float>, 2> render_tile(const SearchFrame& frame, const SearchTile& tile,
                                              const TextureTable& textures);

}  // namespace burnish
