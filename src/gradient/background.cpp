#include "gradient/background.h"

#include <algorithm>

#include "core/parallel.h"
#include "render/render.h"
#include "render/visible_pixels.h"

namespace burnish {

namespace {

/// Iterations with passes over all pixels: every kPeriod'th, so many in all.
constexpr std::uint32_t kPeriod = 8, kFullIterations = 16;

/// The number that other passes begin at: both kinds are numbered on their own, and none comes
/// twice.
std::uint32_t first_near_pass(const BackgroundOptions& options) {
    return std::max(1024u, kFullIterations * options.passes);
}

/// Whether the passes of an iteration are over all pixels.
bool is_everywhere(std::uint32_t iteration) {
    return iteration % kPeriod == 0 && iteration < kFullIterations * kPeriod;
}

}  // namespace

NearUnknown near_unknown(const Film& film, const std::vector<char>& reaching) {
    const int halo = filter_halo(film.filter);
    NearUnknown near;
    near.pixels = dilate(reaching, film.crop_width, film.crop_height, halo);
    near.samples = dilate(near.pixels, film.crop_width, film.crop_height, halo);
    return near;
}

BackgroundTiles trace_background(const Binding& binding, const NearUnknown& near,
                                 const BackgroundOptions& options, std::uint32_t iteration,
                                 const Background& background, const IndexRange& range) {
    const bool everywhere = is_everywhere(iteration);
    if (!everywhere && background.passes >= options.max_passes) return {};
    const std::uint32_t first = everywhere ? iteration / kPeriod * options.passes
                                           : first_near_pass(options) + background.passes;
    // Samples reach a halo further than the pixels that they are for.
    const std::span<const char> samples = everywhere ? std::span<const char>() : near.samples;
    RenderCounts counts;
    BackgroundTiles tiles;
    tiles.sums = render_tiles(constant_part(binding, {options.seed, Stream::kImage}),
                              {0, first, options.passes, samples}, range, &counts);
    tiles.rejected = counts.rejected;
    return tiles;
}

void add_background(const Film& film, const NearUnknown& near, const BackgroundOptions& options,
                    std::uint32_t iteration, const TileImages& sums, Background& background) {
    if (sums.empty()) return;
    add_passes(image_of_tiles(film, options.passes, sums), options.passes,
               is_everywhere(iteration) ? std::span<const char>() : near.pixels, background);
}

std::size_t gather_background(const Binding& binding, const NearUnknown& near,
                              const BackgroundOptions& options, std::uint32_t iteration,
                              Background& background) {
    const Film& film = binding.film();
    const BackgroundTiles tiles =
        trace_background(binding, near, options, iteration, background, {0, tile_count(film)});
    add_background(film, near, options, iteration, tiles.sums, background);
    return tiles.rejected;
}

Background rows_of(const Background& whole, const IndexRange& rows) {
    if (whole.mean.width == 0) return whole;
    const auto wide = static_cast<std::size_t>(whole.mean.width);
    const auto cut = [&](const auto& from, std::size_t of_row, auto& to) {
        to.assign(from.begin() + static_cast<std::ptrdiff_t>(rows.begin * of_row),
                  from.begin() + static_cast<std::ptrdiff_t>(rows.end * of_row));
    };
    Background part;
    part.passes = whole.passes;
    part.mean.width = whole.mean.width, part.mean.height = static_cast<int>(rows.size());
    part.mean.channels = whole.mean.channels;
    cut(whole.mean.values, 3 * wide, part.mean.values);
    cut(whole.counts, wide, part.counts);
    return part;
}

void join_rows(const Background& below, Background& to) {
    to.mean.height += below.mean.height;
    to.mean.values.insert(to.mean.values.end(), below.mean.values.begin(), below.mean.values.end());
    to.counts.insert(to.counts.end(), below.counts.begin(), below.counts.end());
}

void add_passes(const Image& mean, std::uint32_t passes, std::span<const char> only,
                Background& background) {
    background.passes += passes;
    Image& all = background.mean;
    if (all.width == 0) {
        all = make_image(mean.width, mean.height, mean.channels);
        background.counts.assign(all.values.size() / 3, 0);
    }
    constexpr std::size_t kChunk = std::size_t{1} << 15;
    parallel_chunks(background.counts.size(), kChunk, [&](std::size_t i, std::size_t end) {
        for (; i < end; ++i) {
            if (!only.empty() && !only[i]) continue;
            background.counts[i] += passes;
            const float share =
                static_cast<float>(passes) / static_cast<float>(background.counts[i]);
            for (std::size_t k = 3 * i; k < 3 * i + 3; ++k)
                all.values[k] += (mean.values[k] - all.values[k]) * share;
        }
    });
}

}  // namespace burnish
