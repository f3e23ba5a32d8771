#include "gradient/path_cache/path_cache.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "core/parallel.h"
#include "gradient/path_cache/shading.h"
#include "render/visible_pixels.h"

namespace burnish {

namespace {

/// Pixels of a tile that are marked, in the order of tracing.
std::vector<std::uint32_t> marked_pixels(const Tile& tile, const std::vector<char>& marks,
                                         int width) {
    std::vector<std::uint32_t> pixels;
    for_pixels_in_blocks(tile, [&](int x, int y) {
        const auto pixel = static_cast<std::uint32_t>((tile.y0 + y) * width + tile.x0 + x);
        if (marks[pixel]) pixels.push_back(pixel);
    });
    return pixels;
}

/// The least tile that holds these pixels: convolutions have no work to do around them.
Tile bounding_box(std::span<const std::uint32_t> pixels, int width) {
    int x0 = width, x1 = 0, y0 = std::numeric_limits<int>::max(), y1 = 0;
    for (const std::uint32_t pixel : pixels) {
        const int x = static_cast<int>(pixel) % width, y = static_cast<int>(pixel) / width;
        x0 = std::min(x0, x), x1 = std::max(x1, x + 1);
        y0 = std::min(y0, y), y1 = std::max(y1, y + 1);
    }
    return {x0, y0, x1 - x0, y1 - y0};
}

/// Where the derivatives are summed. Of a coloured texture that is read as scalars alone, only the
/// luminance counts: one channel instead of three.
std::vector<TexelSums> make_sums(const Scene& scene, const Theta& theta) {
    std::vector<TexelSums> sums;
    for (const ThetaTexture& t : theta.textures) {
        const Image& texels = t.values;
        const bool of_luminance = texels.channels == 3 && !read_as_color(scene, t.texture);
        sums.push_back(make_texel_sums(texels.width, texels.height,
                                       of_luminance ? 1 : texels.channels, kPoolBands));
        sums.back().of_luminance = of_luminance;
    }
    return sums;
}

}  // namespace

Pool make_pool(const Scene& scene, const Theta& theta) {
    const Film& film = scene.film;
    const std::vector<char> seen = visible_pixels(scene, unknown_bsdfs(scene, theta));
    Pool pool;
    for (const Tile& tile : make_tiles(film, kRecordTile)) {
        auto pixels = marked_pixels(tile, seen, film.crop_width);
        if (pixels.empty()) continue;
        const Tile box = bounding_box(pixels, film.crop_width);
        pool.tiles.push_back({box, std::move(pixels)});
    }
    pool.sums = make_sums(scene, theta);
    pool.normalization = film_normalization(film);
    const int halo = filter_halo(film.filter);
    pool.near_unknown.pixels = dilate(seen, film.crop_width, film.crop_height, halo);
    pool.near_unknown.samples =
        dilate(pool.near_unknown.pixels, film.crop_width, film.crop_height, halo);
    return pool;
}

std::size_t trace_pass(const PoolInput& input, Pool& pool, std::size_t which) {
    Bank& bank = pool.banks[which];
    const Scene& scene = *input.scene->scene;
    const PoolShading shading(scene, *input.theta);
    const std::vector<char> unknowns = unknown_bsdfs(scene, *input.theta);
    const TraceInput trace{input.scene, &shading.textures,       bank_key(input, which),
                           1,           SurfaceChoice::kUnknown, unknowns,
                           true,        input.sequence};
    RecordBatch batch{bank.born, std::vector<TileRecords>(pool.tiles.size())};
    std::vector<std::size_t> rejected(pool.tiles.size());
    parallel_for(pool.tiles.size(), [&](std::size_t i) {
        const auto& [tile, pixels] = pool.tiles[i];
        std::vector<BatchSample> samples(pixels.size());
        for (std::size_t k = 0; k < pixels.size(); ++k)
            samples[k].camera = {pixels[k], bank.born, 0};
        thread_local BatchOutput out;  // scratch memory only
        trace_batch(trace, samples, out);
        batch.tiles[i] = pack_records(out.direct_samples, tile, scene.film.crop_width);
        add_inputs(shading.shaders, batch.tiles[i]);
        rejected[i] = out.rejected;
    });
    bank.batches.push_back(std::move(batch));
    ++bank.born;
    return std::accumulate(rejected.begin(), rejected.end(), std::size_t{0});
}

std::size_t trace_fresh(const PoolInput& input, std::uint32_t passes, Pool& pool) {
    const bool first = pool.banks[0].born == 0;
    std::size_t rejected = 0;
    for (std::uint32_t k = 0; k < (first ? std::max(passes, 2u) : passes); ++k)
        rejected += trace_pass(input, pool, pool.banks[1].born < pool.banks[0].born ? 1 : 0);
    return rejected;
}

void keep_window(Pool& pool, std::size_t window) {
    for (Bank& bank : pool.banks)
        while (bank.batches.size() > window) bank.batches.pop_front();
}

PoolSize pool_size(const Pool& pool) {
    PoolSize size;
    for (const Bank& bank : pool.banks)
        for (const RecordBatch& batch : bank.batches)
            for (const TileRecords& tile : batch.tiles) {
                size.records += tile.count;
                size.bytes +=
                    sizeof(TileRecords) + tile.blocks.capacity() * sizeof(RecordBlock) +
                    tile.runs.capacity() * sizeof(RecordRun) +
                    (tile.constant_inputs.capacity() + tile.derivatives.capacity()) * sizeof(LaneValues);
            }
    return size;
}

}  // namespace burnish
