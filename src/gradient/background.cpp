#include "gradient/background.h"

#include <algorithm>

#include "core/parallel.h"
#include "render/render.h"
#include "render/visible_pixels.h"

namespace burnish {

namespace {

/// Iterations with passes over all pixels: every kPeriod'th, so many in all.
constexpr std::uint32_t kPeriod = 8, kFullIterations = 16;
/// Both kinds of passes are numbered on their own: a low-discrepancy sequence is taken without
/// gaps.
constexpr std::uint32_t kFirstNearPass = 1024;

}  // namespace

NearUnknown near_unknown(const Binding& binding) {
    const Film& film = binding.film();
    const int halo = filter_halo(film.filter);
    NearUnknown near;
    near.pixels = dilate(reaching_pixels(binding.traced, binding.unknown_bsdfs), film.crop_width,
                         film.crop_height, halo);
    near.samples = dilate(near.pixels, film.crop_width, film.crop_height, halo);
    return near;
}

std::size_t gather_background(const Binding& binding, const NearUnknown& near,
                              const BackgroundOptions& options, std::uint32_t iteration,
                              Background& background) {
    const bool everywhere = iteration % kPeriod == 0 && iteration < kFullIterations * kPeriod;
    if (!everywhere && background.passes >= options.max_passes) return 0;
    const std::uint32_t first =
        everywhere ? iteration / kPeriod * options.passes : kFirstNearPass + background.passes;
    // Samples reach a halo further than the pixels that they are for.
    const std::span<const char> samples = everywhere ? std::span<const char>() : near.samples;
    const std::span<const char> pixels = everywhere ? std::span<const char>() : near.pixels;
    RenderCounts counts;
    const Image mean = render(constant_part(binding, {options.seed, Stream::kImage}), 0, first,
                              options.passes, &counts, {}, samples);
    add_passes(mean, options.passes, pixels, background);
    return counts.rejected;
}

Image mean_of(std::span<const Background> backgrounds) {
    Background all = backgrounds.front();
    for (const Background& b : backgrounds.subspan(1))
        for (std::size_t i = 0; i < all.counts.size(); ++i) {
            all.counts[i] += b.counts[i];
            const float share =
                static_cast<float>(b.counts[i]) / static_cast<float>(std::max(1u, all.counts[i]));
            for (std::size_t k = 3 * i; k < 3 * i + 3; ++k)
                all.mean.values[k] += (b.mean.values[k] - all.mean.values[k]) * share;
        }
    return std::move(all.mean);
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
