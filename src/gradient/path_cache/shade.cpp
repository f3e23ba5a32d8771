// Records -> images, one for each half.
#include <algorithm>
#include <numeric>

#include "core/finite_lanes.h"
#include "core/parallel.h"
#include "gradient/path_cache/taps.h"
#include "render/shade_chains.h"

namespace burnish {

namespace {

/// Of all BSDFs, indexed by BsdfId.
using Shaders = std::span<const RecordShader>;

/// Clears the lanes in which the value or a derivative is not finite, and counts them.
std::size_t reject_non_finite(Rgb<Packet>& value, std::span<LaneValues> derivatives) {
    const Packet zero(0.0f);
    Mask finite = finite_lanes(value);
    for (const LaneValues& d : derivatives) finite = finite && finite_lanes(load(d.data()));
    if (all(finite)) return 0;
    value = select(finite, value, Rgb<Packet>{zero, zero, zero});
    for (LaneValues& d : derivatives) store(d.data(), select(finite, load(d.data()), zero));
    std::size_t count = 0;
    for (int k = 0; k < kLanes; ++k) count += !get(finite, k);
    return count;
}

/// What shading a tile needs besides its records.
struct ShadeScratch {
    std::vector<float> pass;                 ///< [height, width, 3] of the tile
    std::vector<LaneValues> unknown_inputs;  ///< of a run
    ChainScratch chains;
    std::vector<float> convolution;
};

/// Adds the values of a block's records to their pixels.
void add_block(const RecordBlock& block, const Rgb<Packet>& value, std::vector<float>& pass) {
    std::array<LaneValues, 3> lanes;
    store(lanes.data(), value);
    for (std::size_t k = 0; k < kLanes; ++k) {
        float* to = &pass[3 * std::size_t{block.pixel[k]}];
        for (std::size_t c = 0; c < 3; ++c) to[c] += lanes[c][k];
    }
}

/// Shades a tile's records into its pass and keeps their derivatives. Returns the number of records
/// that were left out because they are not finite.
std::size_t shade_pass(Shaders shaders, const TileRecords& records, RecordMemory& memory,
                       ShadeScratch& scratch) {
    if (!records.vertices.empty())
        return shade_chains(shaders, records, memory, scratch.chains, scratch.pass);
    std::size_t rejected = 0;
    const LaneValues* constant_inputs = memory.constant_inputs.data();
    LaneValues* derivatives = memory.derivatives.data();
    for (const RecordRun& run : records.runs) {
        const RecordShader& shader = shaders[static_cast<std::size_t>(run.bsdf.value)];
        look_up_unknown(shader, blocks_of(run, records), scratch.unknown_inputs);
        const LaneValues* unknown_inputs = scratch.unknown_inputs.data();
        for (const RecordBlock& block : blocks_of(run, records)) {
            Rgb<Packet> value = shade(shader, block, constant_inputs, unknown_inputs, derivatives);
            rejected += reject_non_finite(value, {derivatives, 3 * shader.derivatives()});
            constant_inputs += shader.constant_inputs.size();
            unknown_inputs += shader.unknown_values();
            derivatives += 3 * shader.derivatives();
            add_block(block, value, scratch.pass);
        }
    }
    return rejected;
}

/// What a tile adds to a half's image, the filter's halo included.
std::vector<float> shade_tile(Shaders shaders, const CacheHalf& half,
                              std::deque<PassMemory>& memory,
                              std::span<const std::array<FilterTaps, 2>> taps, const Tile& tile,
                              std::size_t index, std::size_t& rejected) {
    const int halo = taps[0][0].halo;
    const auto pixels = static_cast<std::size_t>(tile.width * tile.height);
    ShadeScratch scratch;
    scratch.pass.resize(3 * pixels);
    std::vector<float> sum(
        3 * static_cast<std::size_t>((tile.width + 2 * halo) * (tile.height + 2 * halo)), 0.0f);
    for (std::size_t k = 0; k < half.passes.size(); ++k) {
        const TileRecords& records = half.passes[k].tiles[index];
        if (records.count == 0) continue;
        std::fill(scratch.pass.begin(), scratch.pass.end(), 0.0f);
        rejected += shade_pass(shaders, records, memory[k].tiles[index], scratch);
        splat_pass(tile, taps[k], scratch.pass.data(), scratch.convolution, sum.data());
    }
    return sum;
}

/// Brings the memory in line with a half's passes: drops what they dropped, makes what is new.
/// Holds whole passes only, also where memory ends.
void follow_passes(Shaders shaders, const CacheHalf& half, std::deque<PassMemory>& memory) {
    while (!memory.empty() &&
           (half.passes.empty() || memory.front().film_pass != half.passes.front().film_pass))
        memory.pop_front();
    for (std::size_t k = memory.size(); k < half.passes.size(); ++k) {
        const CachedPass& pass = half.passes[k];
        std::vector<RecordMemory> tiles(pass.tiles.size());
        parallel_for(tiles.size(),
                     [&](std::size_t i) { tiles[i] = make_record_memory(shaders, pass.tiles[i]); });
        memory.push_back({pass.film_pass, std::move(tiles)});
    }
}

TileImages shade_half(const PathCacheInput& input, Shaders shaders, const CacheHalf& half,
                      std::size_t which, PathCacheWorkspace& workspace, std::size_t& rejected) {
    std::deque<PassMemory>& memory = workspace.memory[which];
    follow_passes(shaders, half, memory);
    const auto taps = window_taps(input, half, which);
    const std::vector<CacheTile>& tiles = workspace.tiles;
    const IndexRange own = own_tiles(workspace);
    TileImages sums(tiles.size());
    std::vector<std::size_t> left_out(tiles.size(), 0);
    parallel_for(own.size(), [&](std::size_t k) {
        const std::size_t i = own.begin + k;
        sums[i] = shade_tile(shaders, half, memory, taps, tiles[i].tile, i, left_out[i]);
    });
    rejected += std::accumulate(left_out.begin(), left_out.end(), std::size_t{0});
    return sums;
}

/// Calls body(half, its sums).
template <class Body>
void shade_halves(const PathCacheInput& input, const PathCacheState& state,
                  PathCacheWorkspace& workspace, std::size_t& rejected, const Body& body) {
    std::vector<RecordShader> values;
    Shaders shaders = input.binding.shaders;
    if (workspace.use == CacheUse::kImage)
        shaders = values = without_derivatives(input.binding.shaders);
    for (std::size_t h = 0; h < 2; ++h)
        body(h, shade_half(input, shaders, state.halves[h], h, workspace, rejected));
}

}  // namespace

HalfImages shade(const PathCacheInput& input, const PathCacheState& state,
                 PathCacheWorkspace& workspace) {
    HalfImages result;
    shade_halves(
        input, state, workspace, result.rejected, [&](std::size_t h, const TileImages& sums) {
            result.images[h] = half_image(input.binding.film(), state.halves[h], workspace, sums);
        });
    return result;
}

HalfTiles shade_tiles(const PathCacheInput& input, const PathCacheState& state,
                      PathCacheWorkspace& workspace) {
    HalfTiles result;
    shade_halves(input, state, workspace, result.rejected,
                 [&](std::size_t h, TileImages sums) { result.halves[h] = std::move(sums); });
    return result;
}

Image half_image(const Film& film, const CacheHalf& half, const PathCacheWorkspace& workspace,
                 const TileImages& sums) {
    std::vector<Tile> tiles;
    for (const CacheTile& t : workspace.tiles) tiles.push_back(t.tile);
    Image image = make_image(film.crop_width, film.crop_height, 3);
    add_tiles(tiles, filter_halo(film.filter), sums, image);
    normalize_film(workspace.normalization, 1 / static_cast<float>(half.passes.size()), image);
    return image;
}

}  // namespace burnish
