#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "burnish/error.h"
#include "core/parallel.h"
#include "gradient/candidates.h"
#include "gradient/path_cache/path_cache.h"

namespace burnish {

namespace {

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

/// Vertices with unknowns that a camera sample is expected to have, with room to spare, where light
/// bounces. Found with the scene's own textures, so that it does not change in a run.
double expected_vertices(const Binding& binding, const std::vector<char>& seen) {
    constexpr std::size_t kMaxTried = 1 << 14;  // camera samples
    const std::vector<BatchSample> samples = trial_samples(seen, kMaxTried);
    const Theta none;
    const TextureTable textures = texture_table(binding.scene(), none);
    TraceInput input = unknown_derivatives(binding, {0, Stream::kTrial}, 1);
    input.textures = &textures;
    std::vector<std::size_t> vertices((samples.size() + kBatchSamples - 1) / kBatchSamples);
    parallel_chunks(samples.size(), kBatchSamples, [&](std::size_t begin, std::size_t end) {
        ChainOutput out;
        trace_chains(input, std::span(samples).subspan(begin, end - begin), out);
        vertices[begin / kBatchSamples] = out.vertices.size();
    });
    const auto sum = std::accumulate(vertices.begin(), vertices.end(), std::size_t{0});
    return kTrialMargin * static_cast<double>(sum) /
           static_cast<double>(std::max<std::size_t>(1, samples.size()));
}

/// The records of each BSDF in a tile fill whole packets: where tiles see few pixels, or many
/// BSDFs, that counts.
std::size_t bytes_per_pass(const Binding& binding, CacheUse use, const std::vector<char>& seen) {
    const auto shaders =
        use == CacheUse::kImage ? without_derivatives(binding.shaders) : binding.shaders;
    const bool bounces = has_bounces(binding.scene());
    std::size_t each = 0;
    for (std::size_t i = 0; i < shaders.size(); ++i)
        if (binding.unknown_bsdfs[i])
            each = std::max(each,
                            bounces ? bytes_per_vertex(shaders[i]) : bytes_per_record(shaders[i]));
    const double of_pixel = bounces ? expected_vertices(binding, seen) : kTechniques;
    const auto unknown = binding.unknown_bsdfs.size() - static_cast<std::size_t>(std::ranges::count(
                                                            binding.unknown_bsdfs, kNoUnknown));
    std::size_t bytes = 0;
    for (const CacheTile& t : make_cache_tiles(binding.film(), seen)) {
        const auto records =
            static_cast<std::size_t>(std::ceil(of_pixel * static_cast<double>(t.pixels.size())));
        const std::size_t runs = std::max<std::size_t>(1, std::min(unknown, records));
        bytes += padded(records + (kLanes - 1) * (runs - 1)) * each + sizeof(TileRecords) +
                 sizeof(RecordMemory) + runs * sizeof(RecordRun);
    }
    return bytes;
}

}  // namespace

std::vector<TexelSums> make_texel_sums(const Binding& binding) {
    std::vector<TexelSums> sums;
    for (const ThetaTexture& t : binding.theta.textures) {
        const Image& texels = t.values;
        const bool of_luminance =
            texels.channels == 3 && !read_as_color(binding.scene(), t.texture);
        sums.push_back(
            make_texel_sums(texels.width, texels.height, of_luminance ? 1 : texels.channels, 0));
        sums.back().of_luminance = of_luminance;
    }
    return sums;
}

std::vector<CacheTile> make_cache_tiles(const Film& film, const std::vector<char>& reaching) {
    std::vector<CacheTile> tiles;
    for (const Tile& tile : make_tiles(film, kRecordTile)) {
        auto pixels = marked_pixels(tile, reaching, film.crop_width);
        if (pixels.empty()) continue;
        const Tile box = bounding_box(pixels, film.crop_width);
        tiles.push_back({box, std::move(pixels)});
    }
    return tiles;
}

PathCachePlan within(PathCachePlan plan, std::size_t max_bytes) {
    if (max_bytes == 0 || plan.bytes_per_pass == 0) return plan;
    const std::size_t fitting = max_bytes / (2 * plan.bytes_per_pass);
    if (fitting == 0)
        throw ResourceError("a path cache with one pass in each half takes up to " +
                            std::to_string(2 * plan.bytes_per_pass) +
                            " bytes: expected path_cache.max_bytes of at least that, found " +
                            std::to_string(max_bytes));
    plan.window = static_cast<std::uint32_t>(std::min<std::size_t>(plan.window, fitting));
    return plan;
}

PathCachePlan plan(const PathCache& options, const Binding& binding, CacheUse use,
                   const std::vector<char>& reaching) {
    const auto pixels = static_cast<std::size_t>(std::count(reaching.begin(), reaching.end(), 1));
    return within({pixels, bytes_per_pass(binding, use, reaching), options.window},
                  options.max_bytes);
}

PathCacheWorkspace make_workspace(const PathCache& options, const Binding& binding, CacheUse use,
                                  const IndexRange& bands) {
    return make_workspace(options, binding, reaching_pixels(binding), use, bands);
}

PathCacheWorkspace make_workspace(const PathCache& options, const Binding& binding,
                                  const std::vector<char>& seen, CacheUse use,
                                  const IndexRange& bands) {
    PathCacheWorkspace workspace;
    workspace.use = use, workspace.bands = bands;
    workspace.tiles = make_cache_tiles(binding.film(), seen);
    workspace.normalization = film_normalization(binding.film());
    if (use == CacheUse::kImageAndGradient) workspace.sums = make_texel_sums(binding);
    workspace.window =
        options.max_bytes == 0 ? options.window : plan(options, binding, use, seen).window;
    return workspace;
}

std::size_t trace_pass(const PathCacheInput& input, std::size_t which,
                       const PathCacheWorkspace& workspace, PathCacheState& state) {
    CacheHalf& half = state.halves[which];
    TraceInput trace = unknown_derivatives(input.binding, half_key(input, which), 1);
    trace.sequence = input.sequence;
    CachedPass pass{half.passes_traced, std::vector<TileRecords>(workspace.tiles.size())};
    std::vector<std::size_t> rejected(workspace.tiles.size());
    const IndexRange own = own_tiles(workspace);
    parallel_for(own.size(), [&](std::size_t k) {
        const std::size_t i = own.begin + k;
        const auto& [tile, pixels] = workspace.tiles[i];
        std::vector<BatchSample> samples(pixels.size());
        for (std::size_t s = 0; s < pixels.size(); ++s)
            samples[s].camera = {pixels[s], half.passes_traced, 0};
        const int width = input.binding.film().crop_width;
        if (has_bounces(input.binding.scene())) {
            thread_local ChainOutput out;  // scratch memory only
            trace_chains(trace, samples, out);
            pass.tiles[i] = pack_chains(out, samples, tile, width);
            rejected[i] = out.rejected;
        } else {
            thread_local BatchOutput out;  // scratch memory only
            trace_batch(trace, samples, out);
            pass.tiles[i] = pack_records(out.direct_samples, tile, width);
            rejected[i] = out.rejected;
        }
    });
    half.passes.push_back(std::move(pass));
    ++half.passes_traced;
    return std::accumulate(rejected.begin(), rejected.end(), std::size_t{0});
}

std::size_t trace_passes(const PathCacheInput& input, std::uint32_t passes,
                         const PathCacheWorkspace& workspace, PathCacheState& state) {
    const auto& [a, b] = state.halves;
    if (a.passes.empty()) passes = std::max(passes, 2u);
    std::size_t rejected = 0;
    for (std::uint32_t k = 0; k < passes; ++k)
        rejected += trace_pass(input, b.passes_traced < a.passes_traced ? 1 : 0, workspace, state);
    return rejected;
}

void keep_window(std::size_t window, PathCacheState& state, DroppedPasses& dropped) {
    for (std::size_t h = 0; h < 2; ++h) {
        const std::size_t count = state.halves[h].passes.size();
        dropped[h].reserve(dropped[h].size() + count - std::min(window, count));
    }
    for (std::size_t h = 0; h < 2; ++h)
        for (auto& passes = state.halves[h].passes; passes.size() > window; passes.pop_front())
            dropped[h].push_back(std::move(passes.front()));
}

PathCacheMark mark(const PathCacheState& state) {
    const auto& [a, b] = state.halves;
    return {{a.passes.size(), b.passes.size()}, {a.passes_traced, b.passes_traced}};
}

void roll_back(const PathCacheMark& mark, DroppedPasses dropped, PathCacheState& state) {
    for (std::size_t h = 0; h < 2; ++h) {
        auto& passes = state.halves[h].passes;
        passes.insert(passes.begin(), std::make_move_iterator(dropped[h].begin()),
                      std::make_move_iterator(dropped[h].end()));
        passes.resize(mark.passes[h]);
        state.halves[h].passes_traced = mark.passes_traced[h];
    }
}

PathCacheSize size_of(const PathCacheState& state, const PathCacheWorkspace& workspace) {
    PathCacheSize size;
    for (const CacheHalf& half : state.halves)
        for (const CachedPass& pass : half.passes)
            for (const TileRecords& tile : pass.tiles) {
                size.records += tile.count;
                size.bytes += bytes_of(tile);
            }
    for (const auto& memory : workspace.memory)
        for (const PassMemory& pass : memory)
            for (const RecordMemory& tile : pass.tiles)
                size.bytes += sizeof(RecordMemory) +
                              (tile.constant_inputs.capacity() + tile.derivatives.capacity()) *
                                  sizeof(LaneValues);
    return size;
}

}  // namespace burnish
