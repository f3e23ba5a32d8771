#include "optimize/band_memory.h"

#include <algorithm>
#include <tuple>

#include "core/parallel.h"
#include "gradient/candidates.h"
#include "gradient/path_cache/path_cache.h"

namespace burnish {

namespace {

/// A block of texels to which a camera sample of a band came.
struct BlockVisit {
    std::uint32_t slot = 0, band = 0, block = 0, sample = 0;

    friend auto operator<=>(const BlockVisit&, const BlockVisit&) = default;
};

/// Blocks to which samples came: all, and those to which one sample came, or two.
struct BlockCounts {
    double all = 0, once = 0, twice = 0;
};

/// The band of each pixel that light from an unknown can reach.
std::vector<std::uint32_t> bands_of_pixels(const Film& film, const std::vector<char>& reaching) {
    std::vector<std::uint32_t> bands(reaching.size());
    const std::vector<CacheTile> tiles = make_cache_tiles(film, reaching);
    for (std::uint32_t band = 0; band < kViewBands; ++band) {
        const IndexRange own = tiles_of({band, band + 1}, tiles.size());
        for (std::size_t i = own.begin; i < own.end; ++i)
            for (const std::uint32_t pixel : tiles[i].pixels) bands[pixel] = band;
    }
    return bands;
}

/// Camera samples, first to first + count, at pixels that are drawn independently of each other
/// from those that are marked.
std::vector<BatchSample> drawn_samples(const std::vector<char>& reaching, RandomKey key,
                                       std::uint32_t first, std::uint32_t count) {
    std::vector<std::uint32_t> pixels;
    for (std::uint32_t pixel = 0; pixel < reaching.size(); ++pixel)
        if (reaching[pixel]) pixels.push_back(pixel);
    std::vector<BatchSample> samples;
    if (pixels.empty()) return samples;
    for (std::uint32_t i = first; i < first + count; ++i) {
        const double u = double{uniforms(key, i, 0, 0)[0]};
        const auto at = static_cast<std::size_t>(u * static_cast<double>(pixels.size()));
        samples.push_back({{pixels[at], i, 0}});
    }
    std::ranges::sort(samples, {}, [](const BatchSample& s) { return s.camera.pixel; });
    return samples;
}

/// The blocks that samples of a view come to.
std::vector<BlockVisit> visits_of(const Binding& binding, const std::vector<char>& reaching,
                                  RandomKey key, std::span<const BatchSample> samples,
                                  const std::vector<TexelSums>& sums) {
    std::vector<BlockVisit> visits;
    const std::vector<std::uint32_t> bands = bands_of_pixels(binding.film(), reaching);
    for (const TracedPath& traced :
         trace_paths(unknown_derivatives(binding, key, 1), samples).paths) {
        const CameraSample& camera = traced.path.camera;
        for (const UnknownInput& input : binding.shader(traced.record.bsdf).unknowns) {
            const TexelSums& own = sums[static_cast<std::size_t>(input.slot)];
            const TexelFootprint f = footprint(binding.bitmap(input.texture), traced.record.uv);
            for (std::size_t k = 0; k < static_cast<std::size_t>(f.count); ++k)
                visits.push_back({static_cast<std::uint32_t>(input.slot), bands[camera.pixel],
                                  block_of(own, f.texel[k] % own.width, f.texel[k] / own.width),
                                  camera.iteration});
        }
    }
    return visits;
}

/// Of each slot.
std::vector<BlockCounts> count_blocks(std::vector<BlockVisit> visits, std::size_t slots) {
    std::vector<BlockCounts> counts(slots);
    std::ranges::sort(visits);
    visits.erase(std::unique(visits.begin(), visits.end()), visits.end());
    const auto block = [](const BlockVisit& v) { return std::tuple{v.slot, v.band, v.block}; };
    for (auto first = visits.begin(); first != visits.end();) {
        const auto last = std::find_if(
            first, visits.end(), [&](const BlockVisit& v) { return block(v) != block(*first); });
        BlockCounts& own = counts[first->slot];
        ++own.all, own.once += last - first == 1, own.twice += last - first == 2;
        first = last;
    }
    return counts;
}

/// How many there are, those to which no sample came included [C84].
double estimate_blocks(const BlockCounts& n) {
    return n.all + n.once * n.once / (2 * std::max(1.0, n.twice));
}

}  // namespace

double band_bytes(std::span<const TracedScene> views, std::span<const std::vector<char>> reaching,
                  const Theta& theta, std::uint32_t seed) {
    constexpr std::uint32_t kTried = 1 << 14;  // camera samples of all views together
    constexpr std::size_t kAtOnce = 4;         // views, of which each has 8 bytes a pixel
    const RandomKey key{seed, Stream::kTrial};
    const auto each = std::max(1u, kTried / static_cast<std::uint32_t>(views.size()));
    const std::vector<TexelSums> sums = make_texel_sums(Binding(views.front(), theta));
    std::vector<std::vector<BlockVisit>> of_view(views.size());
    parallel_tasks(views.size(), kAtOnce, [&](std::size_t i) {
        const auto first = static_cast<std::uint32_t>(i) * each;
        of_view[i] = visits_of(Binding(views[i], theta), reaching[i], key,
                               drawn_samples(reaching[i], key, first, each), sums);
    });
    std::vector<BlockVisit> visits;
    for (const auto& own : of_view) visits.insert(visits.end(), own.begin(), own.end());
    const std::vector<BlockCounts> counts = count_blocks(std::move(visits), sums.size());
    double bytes = 0;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const double max = static_cast<double>(kViewBands * block_count(sums[i]));
        bytes += std::min(kTrialMargin * estimate_blocks(counts[i]), max) *
                 static_cast<double>(kBlockTexels * sums[i].channels * sizeof(float));
    }
    return bytes;
}

}  // namespace burnish
