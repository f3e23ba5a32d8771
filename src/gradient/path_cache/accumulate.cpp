// Records + adjoints -> the gradient by texel.

#include "core/contract.h"
#include "core/parallel.h"
#include "gradient/path_cache/taps.h"

namespace burnish {

namespace {

/// Spreads sixteen derivatives by the channels of a texture's value over its texels.
template <class Block>
void scatter(const Bitmap& bitmap, const Block& block, const Rgb<Packet>& g, const TexelSums& sums,
             TexelBand& band) {
    const FootprintPackets foot =
        footprint_packets(bitmap, Vec2<Packet>{load(block.u.data()), load(block.v.data())});
    for (std::size_t b = 0; b < foot.taps; ++b)
        for (std::size_t a = 0; a < foot.taps; ++a)
            add(sums, band, foot.x[a], foot.y[b], g * (foot.weight_y[b] * foot.weight_x[a]));
}

/// w(x) of sixteen records: one channel of the weights of its pass per entry.
Rgb<Packet> weights_of(const std::array<std::uint16_t, kLanes>& pixel,
                       const std::vector<float>& weights) {
    LaneIntegers first;
    for (int k = 0; k < kLanes; ++k) set(first, k, 3u * pixel[static_cast<std::size_t>(k)]);
    return {gather(&weights[0], first), gather(&weights[1], first), gather(&weights[2], first)};
}

/// dL by the channels of one input's texture [PR eq. 5], as many as are summed. df: the derivatives
/// of the value's channels by the seeds, from this input's on; moves to the next input's.
Rgb<Packet> input_gradient(const RecordShader& shader, const UnknownInput& input, int channels,
                           const Rgb<Packet>& weight, const LaneValues*& df) {
    const auto next = [&] {
        const Rgb<Packet> product = weight * load(df);
        df += 3;
        return product;
    };
    const auto next_sum = [&] {
        const Rgb<Packet> v = next();
        return v.x + v.y + v.z;
    };
    if (!input.is_color) return scalar_to_texel(channels, next_sum());
    Rgb<Packet> g;
    if (shader.mixes_channels)
        for (int c = 0; c < 3; ++c) g[c] = next_sum();
    else
        g = next();
    return color_to_texel(channels, g);
}

/// Asks for what `accumulate_blocks` reads of a block: too little of it to be foreseen.
template <class Block>
void prefetch(const Block& block) {
    __builtin_prefetch(block.u.data());
    __builtin_prefetch(block.v.data());
    __builtin_prefetch(&block.v.back());
    __builtin_prefetch(block.pixel.data());
}

/// Adds the derivatives of consecutive blocks, weighted by w(x), to the texels; moves `df` on.
template <class Block>
void accumulate_blocks(const Binding& binding, const RecordShader& shader,
                       std::span<const Block> blocks, const std::vector<float>& weights,
                       std::size_t band, const LaneValues*& df, std::vector<TexelSums>& all_sums) {
    constexpr std::size_t kAhead = 4;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
        const Block& block = blocks[k];
        if (k + kAhead < blocks.size()) prefetch(blocks[k + kAhead]);
        const Rgb<Packet> weight = weights_of(block.pixel, weights);
        for (const UnknownInput& input : shader.unknowns) {
            TexelSums& sums = all_sums[static_cast<std::size_t>(input.slot)];
            const Rgb<Packet> g =
                input_gradient(shader, input, static_cast<int>(sums.channels), weight, df);
            scatter(binding.bitmap(input.texture), block, g, sums, sums.bands[band]);
        }
    }
}

/// The same of a tile's records.
void accumulate_pass(const Binding& binding, const TileRecords& records, const RecordMemory& memory,
                     const std::vector<float>& weights, std::size_t band,
                     std::vector<TexelSums>& sums) {
    const LaneValues* df = memory.derivatives.data();
    for (const RecordRun& run : records.runs) {
        const RecordShader& shader = binding.shader(run.bsdf);
        if (records.vertices.empty())
            accumulate_blocks(binding, shader, blocks_of(run, records), weights, band, df, sums);
        else
            accumulate_blocks(binding, shader, vertices_of(run, records), weights, band, df, sums);
    }
}

/// Adds a half's derivatives, weighted by dL/dI of the other half's image times `share`, to the
/// sums.
void accumulate_half(const PathCacheInput& input, const CacheHalf& half, std::size_t which,
                     const Image& adjoint, float share, PathCacheWorkspace& workspace) {
    const Image weighted = normalized_adjoint(adjoint, workspace.normalization, share);
    const auto taps = window_taps(input, half, which);
    const std::vector<CacheTile>& tiles = workspace.tiles;
    const IndexRange own = workspace.bands;
    parallel_for(own.size(), [&](std::size_t band) {
        std::vector<float> weights(3 * kRecordTile * kRecordTile), scratch;
        const std::size_t number = own.begin + band;
        const IndexRange in_band = tiles_of({number, number + 1}, tiles.size());
        for (std::size_t i = in_band.begin; i < in_band.end; ++i)
            for (std::size_t k = 0; k < half.passes.size(); ++k) {
                const TileRecords& records = half.passes[k].tiles[i];
                if (records.count == 0) continue;
                gather_pass(tiles[i].tile, taps[k], weighted, scratch, weights.data());
                accumulate_pass(input.binding, records, workspace.memory[which][k].tiles[i],
                                weights, band, workspace.sums);
            }
    });
}

/// Makes the gradients of the nodes zero.
void clear_nodes(PathCacheWorkspace& workspace) {
    const std::vector<IndexRange> nodes = nodes_of(workspace.bands);
    workspace.gradient.resize(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        BandGradient& node = workspace.gradient[n];
        node.bands = nodes[n];
        node.gradient.resize(workspace.sums.size());
        for (std::size_t i = 0; i < workspace.sums.size(); ++i) {
            const TexelSums& sums = workspace.sums[i];
            clear(node.gradient[i], static_cast<int>(sums.width), static_cast<int>(sums.height),
                  out_channels(sums));
        }
    }
}

/// Moves what its bands have summed up to one half of a node's gradient.
void fold_node(std::size_t half, BandGradient& node, PathCacheWorkspace& workspace) {
    const std::size_t first = node.bands.begin - workspace.bands.begin;
    for (std::size_t i = 0; i < workspace.sums.size(); ++i) {
        SplitGradient& gradient = node.gradient[i];
        fold(workspace.sums[i], {first, first + node.bands.size()},
             half == 0 ? gradient.first : gradient.second, gradient.dirty);
    }
}

}  // namespace

const std::vector<BandGradient>& accumulate_bands(const PathCacheInput& input,
                                                  const PathCacheState& state,
                                                  const std::array<const Image*, 2>& adjoints,
                                                  PathCacheWorkspace& workspace) {
    clear_nodes(workspace);
    for (TexelSums& sums : workspace.sums) reserve_bands(workspace.bands.size(), sums);
    for (std::size_t h = 0; h < 2; ++h) {
        // The mean over the passes of the half, and over the halves.
        const float share = 0.5f / static_cast<float>(state.halves[h].passes.size());
        accumulate_half(input, state.halves[h], h, *adjoints[1 - h], share, workspace);
        for (BandGradient& node : workspace.gradient) fold_node(h, node, workspace);
    }
    return workspace.gradient;
}

const std::vector<SplitGradient>& accumulate(const PathCacheInput& input,
                                             const PathCacheState& state,
                                             const std::array<const Image*, 2>& adjoints,
                                             PathCacheWorkspace& workspace) {
    BURNISH_REQUIRE(workspace.bands.size(), ==, kViewBands);
    return accumulate_bands(input, state, adjoints, workspace).front().gradient;
}

}  // namespace burnish
