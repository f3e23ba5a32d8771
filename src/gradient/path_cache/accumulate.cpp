// The second half of a pool's iteration: its records to images, and to the gradient.
#include <algorithm>
#include <limits>
#include <numeric>

#include "core/parallel.h"
#include "gradient/path_cache/outliers.h"
#include "gradient/path_cache/shading.h"

namespace burnish {

namespace {

/// The filter's weights of the passes in a bank's window, oldest first.
std::vector<std::array<FilterTaps, 2>> window_taps(const PoolInput& input, const Bank& bank,
                                                   std::size_t which) {
    const ReconstructionFilter& filter = input.scene->scene->film.filter;
    std::vector<std::array<FilterTaps, 2>> taps;
    for (const RecordBatch& batch : bank.batches)
        taps.push_back(
            pass_taps(filter, bank_key(input, which), batch.film_pass, 1, input.sequence).taps[0]);
    return taps;
}

/// Clears the lanes in which the value or a derivative is not finite, and counts them.
std::size_t reject_non_finite(Rgb<Packet>& value, std::span<LaneValues> derivatives) {
    const Packet largest(std::numeric_limits<float>::max()), zero(0.0f);
    auto finite = abs(value.x) <= largest && abs(value.y) <= largest && abs(value.z) <= largest;
    for (const LaneValues& d : derivatives) finite = finite && abs(load(d.data())) <= largest;
    if (all(finite)) return 0;
    value = select(finite, value, Rgb<Packet>{zero, zero, zero});
    for (LaneValues& d : derivatives) store(d.data(), select(finite, load(d.data()), zero));
    std::size_t count = 0;
    for (int k = 0; k < kLanes; ++k) count += !get(finite, k);
    return count;
}

/// What shading a tile needs besides its records.
struct ShadeScratch {
    std::vector<float> pass;         ///< [height, width, 3] of the tile
    std::vector<LaneValues> unknown_inputs;  ///< the inputs of a run that read optimised textures
    std::vector<float> convolution;
};

/// Shades a tile's records into its pass and keeps their derivatives. Returns the number of records
/// that were left out because they are not finite.
std::size_t shade_pass(const PoolShading& shading, TileRecords& records, ShadeScratch& scratch) {
    std::size_t rejected = 0;
    for (const RecordRun& run : records.runs) {
        const RecordShader& shader = shading[run.bsdf];
        look_up_unknown(shader, blocks_of(run, records), scratch.unknown_inputs);
        const LaneValues *constant_inputs = records.constant_inputs.data() + run.constant_inputs, *unknown_inputs = scratch.unknown_inputs.data();
        LaneValues* derivatives = records.derivatives.data() + run.derivatives;
        for (const RecordBlock& block : blocks_of(run, records)) {
            Rgb<Packet> value = shade(shader, block, constant_inputs, unknown_inputs, derivatives);
            rejected += reject_non_finite(value, {derivatives, 3 * shader.seeds.size()});
            constant_inputs += shader.constant_inputs.size(), unknown_inputs += shader.unknown_inputs.size();
            derivatives += 3 * shader.seeds.size();
            std::array<LaneValues, 3> lanes;
            store(lanes.data(), value);
            for (std::size_t k = 0; k < kLanes; ++k) {
                float* to = &scratch.pass[3 * std::size_t{block.pixel[k]}];
                for (std::size_t c = 0; c < 3; ++c) to[c] += lanes[c][k];
            }
        }
    }
    return rejected;
}

/// What a tile adds to a bank's image, halo included.
std::vector<float> shade_tile(const PoolShading& shading, Bank& bank,
                              std::span<const std::array<FilterTaps, 2>> taps, const Tile& tile,
                              std::size_t index, std::size_t& rejected) {
    const int halo = taps[0][0].halo;
    const auto pixels = static_cast<std::size_t>(tile.width * tile.height);
    ShadeScratch scratch;
    scratch.pass.resize(3 * pixels);
    std::vector<float> sum(
        3 * static_cast<std::size_t>((tile.width + 2 * halo) * (tile.height + 2 * halo)), 0.0f);
    for (std::size_t k = 0; k < bank.batches.size(); ++k) {
        TileRecords& records = bank.batches[k].tiles[index];
        if (records.count == 0) continue;
        std::fill(scratch.pass.begin(), scratch.pass.end(), 0.0f);
        rejected += shade_pass(shading, records, scratch);
        splat_pass(tile, taps[k], scratch.pass.data(), scratch.convolution, sum.data());
    }
    return sum;
}

std::vector<Tile> tiles_of(const Pool& pool) {
    std::vector<Tile> tiles;
    for (const PoolTile& t : pool.tiles) tiles.push_back(t.tile);
    return tiles;
}

Image bank_image(const PoolInput& input, Pool& pool, const PoolShading& shading, std::size_t which,
                 std::size_t& rejected) {
    Bank& bank = pool.banks[which];
    const Film& film = input.scene->scene->film;
    const auto taps = window_taps(input, bank, which);
    std::vector<std::vector<float>> sums(pool.tiles.size());
    std::vector<std::size_t> left_out(pool.tiles.size(), 0);
    parallel_for(pool.tiles.size(), [&](std::size_t i) {
        sums[i] = shade_tile(shading, bank, taps, pool.tiles[i].tile, i, left_out[i]);
    });
    Image image = make_image(film.crop_width, film.crop_height, 3);
    add_tiles(tiles_of(pool), filter_halo(film.filter), sums, image);
    rejected += std::accumulate(left_out.begin(), left_out.end(), std::size_t{0});
    normalize_film(pool.normalization, 1 / static_cast<float>(bank.batches.size()), image);
    return image;
}

/// Spreads sixteen derivatives by the channels of a texture's value over its texels.
void scatter(const Bitmap& bitmap, const RecordBlock& block, const Rgb<Packet>& g,
             const TexelSums& sums, TexelBand& band) {
    const FootprintPackets foot =
        footprint_packets(bitmap, Vec2<Packet>{load(block.u.data()), load(block.v.data())});
    for (std::size_t b = 0; b < foot.taps; ++b)
        for (std::size_t a = 0; a < foot.taps; ++a)
            add(sums, band, foot.x[a], foot.y[b], g * (foot.weight_y[b] * foot.weight_x[a]));
}

/// w(x) of a block's records: one channel of the weights of its pass per entry.
Rgb<Packet> weights_of(const RecordBlock& block, const std::vector<float>& weights) {
    LaneIntegers first;
    for (std::size_t k = 0; k < kLanes; ++k) first[k] = 3u * block.pixel[k];
    return {gather(&weights[0], first), gather(&weights[1], first), gather(&weights[2], first)};
}

/// dL by the channels of one input's texture [PR eq. 5], as many as are summed. df: the derivatives
/// of the value's channels by the seeds, from this input's on; moves to the next input's.
Rgb<Packet> input_gradient(const RecordShader& shader, const UnknownInput& input,
                           std::uint32_t channels, const Rgb<Packet>& weight,
                           const LaneValues*& df) {
    const Packet zero(0.0f);
    const auto next = [&] {
        const Rgb<Packet> product = weight * load(df);
        df += 3;
        return product;
    };
    const auto next_sum = [&] {
        const Rgb<Packet> v = next();
        return v.x + v.y + v.z;
    };
    if (input.input > 0) {  // a scalar: of an RGB texture, the luminance
        const Packet g = next_sum();
        return channels == 1 ? Rgb<Packet>{g, zero, zero} : luminance_derivative(g);
    }
    Rgb<Packet> g;
    if (shader.mixes_channels)
        for (int c = 0; c < 3; ++c) g[c] = next_sum();
    else
        g = next();
    return channels == 1 ? Rgb<Packet>{g.x + g.y + g.z, zero, zero} : g;
}

/// The gradient of a run of work: where its texels are summed, and what stands out.
struct GradientBand {
    const Scene* scene = nullptr;
    std::vector<TexelSums>* sums = nullptr;  ///< parallel to theta.textures
    std::size_t band = 0;
    const RecordView* view = nullptr;
    OutlierSearch* search = nullptr;
};

Packet largest_channel(const Rgb<Packet>& g) { return max(max(abs(g.x), abs(g.y)), abs(g.z)); }

/// Adds the derivatives of a tile's records, weighted by w(x), to the texels.
void differentiate_pass(const PoolShading& shading, RecordPlace place,
                        const std::vector<float>& weights, const GradientBand& to) {
    const TileRecords& records = *place.records;
    const Packet worth = worth_looking(*to.search, to.view->share);
    for (const RecordRun& run : records.runs) {
        const RecordShader& shader = shading[run.bsdf];
        const LaneValues* df = records.derivatives.data() + run.derivatives;
        for (std::uint32_t i = run.begin; i < run.end; ++i) {
            const RecordBlock& block = records.blocks[i];
            const Rgb<Packet> weight = weights_of(block, weights);
            Packet bound(0.0f);  // inputs may share a texel, and a texel's weights are at most 1
            for (const UnknownInput& input : shader.unknowns) {
                const auto& bitmap = std::get<Bitmap>((*to.scene)[input.texture]);
                TexelSums& sums = (*to.sums)[static_cast<std::size_t>(input.slot)];
                const Rgb<Packet> g = input_gradient(shader, input, sums.channels, weight, df);
                scatter(bitmap, block, g, sums, sums.bands[to.band]);
                bound = bound + largest_channel(g);
            }
            if (!any(bound >= worth)) continue;
            place.run = &run, place.block = i;
            look_closer(*to.view, place, bound, to.band, *to.search);
        }
    }
}

/// Adds a bank's derivatives, weighted by dL/dI of the other bank's image times `share`, to the
/// pool's sums.
void sum_derivatives(const PoolInput& input, const PoolShading& shading, const Image& adjoint,
                     float share, std::size_t which, Pool& pool, OutlierSearch& search) {
    const Bank& bank = pool.banks[which];
    const Scene& scene = *input.scene->scene;
    const Image weighted = normalized_adjoint(adjoint, pool.normalization, share);
    const auto taps = window_taps(input, bank, which);
    const PassTaps by_pass{bank.batches.front().film_pass, taps};
    const std::vector<int> slots = theta_slots(scene, *input.theta);
    const RecordView view{
        {&scene, &shading.textures, slots, &weighted, &by_pass, Target::kIntegrand}, share};
    const std::size_t per_band = (pool.tiles.size() + kPoolBands - 1) / kPoolBands;
    parallel_for(kPoolBands, [&](std::size_t band) {
        const GradientBand to{&scene, &pool.sums, band, &view, &search};
        std::vector<float> weights(3 * kRecordTile * kRecordTile), scratch;
        const std::size_t end = std::min(pool.tiles.size(), (band + 1) * per_band);
        for (std::size_t i = band * per_band; i < end; ++i)
            for (std::size_t k = 0; k < bank.batches.size(); ++k) {
                const TileRecords& records = bank.batches[k].tiles[i];
                if (records.count == 0) continue;
                gather_pass(pool.tiles[i].tile, taps[k], weighted, scratch, weights.data());
                differentiate_pass(
                    shading, {&records, nullptr, 0, pool.tiles[i].tile, bank.batches[k].film_pass},
                    weights, to);
            }
    });
}

}  // namespace

PoolImages pool_images(const PoolInput& input, Pool& pool) {
    const PoolShading shading(*input.scene->scene, *input.theta);
    PoolImages result;
    for (std::size_t b = 0; b < 2; ++b)
        result.images[b] = bank_image(input, pool, shading, b, result.rejected);
    return result;
}

const std::vector<SplitGradient>& pool_gradient(const PoolInput& input, Pool& pool,
                                                 const std::array<Image, 2>& adjoints) {
    const PoolShading shading(*input.scene->scene, *input.theta);
    pool.gradient.resize(pool.sums.size());
    for (std::size_t i = 0; i < pool.sums.size(); ++i) {
        const TexelSums& sums = pool.sums[i];
        clear(pool.gradient[i], static_cast<int>(sums.width), static_cast<int>(sums.height),
              out_channels(sums));
    }
    OutlierSearch search;
    search.found.resize(kPoolBands);
    for (std::size_t b = 0; b < 2; ++b) {
        // The mean over the passes of the bank, and over the banks.
        const float share = 0.5f / static_cast<float>(pool.banks[b].batches.size());
        sum_derivatives(input, shading, adjoints[1 - b], share, b, pool, search);
        for (std::size_t i = 0; i < pool.sums.size(); ++i) {
            SplitGradient& gradient = pool.gradient[i];
            fold(pool.sums[i], b == 0 ? gradient.first : gradient.second, gradient.reached);
        }
    }
    pool.outliers = result_of(search);
    return pool.gradient;
}

}  // namespace burnish
