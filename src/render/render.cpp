#include "render/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "burnish/error.h"
#include "core/parallel.h"
#include "paths/primary_rays.h"
#include "render/pass_convolution.h"
#include "render/telling.h"

namespace burnish {

namespace {

constexpr int kTile = 16;             // pixels on a side: the unit of work of a thread
constexpr std::uint32_t kGroup = 16;  // passes that are traced together

/// What is found for each sample of a batch; the number of rejected samples.
using TraceBatch = std::size_t (*)(const TraceInput&, std::span<const BatchSample>,
                                   std::span<Rgbf>);

/// What each sample of a group of passes brings: radiance[pass] is [height, width] of the tile.
/// All passes of a pixel follow one another, so that a packet's rays start together and meet
/// neighbouring points. Returns the number of rejected samples.
std::size_t trace_group(const TraceInput& input, TraceBatch trace_batch, const Tile& tile,
                        std::span<const std::uint32_t> pixels, const Passes& group,
                        std::vector<std::vector<Rgbf>>& radiance) {
    std::array<BatchSample, kBatchSamples> samples;
    std::array<Rgbf, kBatchSamples> traced;
    const std::size_t all = pixels.size() * group.count;
    const int film_width = input.scene->film.crop_width;
    std::size_t rejected = 0;
    for (std::size_t begin = 0; begin < all; begin += kBatchSamples) {
        const std::size_t count = std::min<std::size_t>(kBatchSamples, all - begin);
        for (std::size_t i = 0; i < count; ++i)
            samples[i].camera = {
                pixels[(begin + i) / group.count], group.iteration,
                group.first + static_cast<std::uint32_t>((begin + i) % group.count)};
        rejected += trace_batch(input, {samples.data(), count}, {traced.data(), count});
        for (std::size_t i = 0; i < count; ++i) {
            const CameraSample& s = samples[i].camera;
            radiance[s.pass - group.first][pixel_in(tile, s.pixel, film_width)] = traced[i];
        }
    }
    return rejected;
}

/// What a tile adds to the image, the filter's halo included; empty where it has no sample.
struct TileSum {
    std::vector<float> values;
    std::size_t rejected = 0;
};

/// taps: of each pass. Calls after_group(passes) after each group of passes.
template <class AfterGroup>
TileSum render_tile(const TraceInput& input, TraceBatch trace_batch, const Tile& tile,
                    const Passes& passes, std::span<const std::array<FilterTaps, 2>> taps,
                    const AfterGroup& after_group) {
    const int halo = taps[0][0].halo;
    const auto pixels = marked_pixels(tile, passes.only, input.scene->film.crop_width);
    if (pixels.empty()) {
        after_group(passes.count);
        return {};
    }
    TileSum sum;
    const auto floats =
        3 * static_cast<std::size_t>((tile.width + 2 * halo) * (tile.height + 2 * halo));
    std::vector<double> total(floats);  // of groups: there may be thousands of them
    std::vector<float> of_group, scratch;
    std::vector<std::vector<Rgbf>> radiance(
        std::min(kGroup, passes.count),
        std::vector<Rgbf>(static_cast<std::size_t>(tile.width * tile.height)));
    for (std::uint32_t p = 0; p < passes.count; p += kGroup) {
        const std::uint32_t count = std::min(kGroup, passes.count - p);
        const Passes group{passes.iteration, passes.first + p, count, passes.only};
        sum.rejected += trace_group(input, trace_batch, tile, pixels, group, radiance);
        of_group.assign(floats, 0.0f);
        for (std::uint32_t k = 0; k < count; ++k)
            splat_pass(tile, taps[p + k], &radiance[k][0].x, scratch, of_group.data());
        for (std::size_t i = 0; i < floats; ++i) total[i] += static_cast<double>(of_group[i]);
        after_group(count);
    }
    sum.values.assign(total.begin(), total.end());
    return sum;
}

TileImages tiles_with(const TraceInput& input, TraceBatch trace_batch, const Passes& passes,
                      const IndexRange& range, RenderCounts* counts, const Progress& progress) {
    const Film& film = input.scene->film;
    const std::uint32_t first =
        film_pass({0, passes.iteration, passes.first}, input.passes_per_iteration);
    const PassTaps taps = pass_taps(film.filter, input.key, first, passes.count, input.sequence);
    const std::vector<Tile> tiles = make_tiles(film, kTile);
    TileImages sums(tiles.size());
    std::vector<std::size_t> rejected(tiles.size(), 0);
    Telling telling(progress, 1.0 * passes.count * static_cast<double>(range.size()));
    parallel_for(range.size(), [&](std::size_t k) {
        const std::size_t i = range.begin + k;
        TileSum sum = render_tile(input, trace_batch, tiles[i], passes, taps.taps,
                                  [&](std::uint32_t group) { telling.add(group); });
        sums[i] = std::move(sum.values);
        rejected[i] = sum.rejected;
    });
    telling.tell();
    if (counts)
        counts->rejected += std::accumulate(rejected.begin(), rejected.end(), std::size_t{0});
    return sums;
}

Image render_with(const TraceInput& input, TraceBatch trace_batch, const Passes& passes,
                  RenderCounts* counts, const Progress& progress) {
    const Film& film = input.scene->film;
    return image_of_tiles(
        film, passes.count,
        tiles_with(input, trace_batch, passes, {0, tile_count(film)}, counts, progress));
}

}  // namespace

void require_few_rejected(std::size_t rejected, std::size_t all, const char* what,
                          const char* reason) {
    if (static_cast<double>(rejected) > kMaxRejectedShare * static_cast<double>(all))
        throw InputError(
            fmt::format("{} of {} {} were not finite, expected at most one in 1000: {}", rejected,
                        all, what, reason));
}

std::size_t tile_count(const Film& film) { return make_tiles(film, kTile).size(); }

TileImages render_tiles(const TraceInput& input, const Passes& passes, const IndexRange& range,
                        RenderCounts* counts, const Progress& progress) {
    return tiles_with(input, trace_radiance, passes, range, counts, progress);
}

Image image_of_tiles(const Film& film, std::uint32_t passes, const TileImages& sums) {
    Image image = make_image(film.crop_width, film.crop_height, 3);
    add_tiles(make_tiles(film, kTile), filter_halo(film.filter), sums, image);
    normalize_film(film_normalization(film), 1 / static_cast<float>(passes), image);
    return image;
}

Image render(const TraceInput& input, std::uint32_t iteration, std::uint32_t passes,
             RenderCounts* counts, const Progress& progress) {
    return render_with(input, trace_radiance, {iteration, 0, passes}, counts, progress);
}

Image render_alpha(const TraceInput& input, std::uint32_t passes) {
    const auto coverage = [](const TraceInput& in, std::span<const BatchSample> samples,
                             std::span<Rgbf> seen) {
        trace_coverage(in, samples, seen);
        return std::size_t{0};
    };
    const Image image = render_with(input, coverage, {0, 0, passes}, nullptr, {});
    Image alpha = make_image(image.width, image.height, 1);
    for (std::size_t i = 0; i < alpha.values.size(); ++i) {
        const float weight = image.values[3 * i + 1];  // 0 where a filter reaches no sample
        alpha.values[i] = weight != 0 ? image.values[3 * i] / weight : 0;
    }
    return alpha;
}

}  // namespace burnish
