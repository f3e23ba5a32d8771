// The part of the image that no unknown reaches: constant under theta, gathered over the
// iterations.
//
// All pixels get passes in every eighth of its iterations until there are sixteen such. In the
// others, pixels that mix the background with unknowns get them, until they have as many as are
// asked for: only there does its noise reach a derivative.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/index_range.h"
#include "gradient/binding.h"
#include "image/image.h"
#include "image/whole.h"
#include "render/pass_convolution.h"

namespace burnish {

/// Values only. Of several processes that share a view each keeps some rows of pixels.
struct Background {
    Image mean;                         ///< of the passes so far, [crop_height, crop_width, 3]
    std::vector<std::uint32_t> counts;  ///< of each pixel: passes in its mean
    std::uint32_t passes = 0;           ///< made so far, over some or all pixels

    friend bool operator==(const Background&, const Background&) = default;
};

/// Whether it has three values and a count for each pixel, or nothing: what a file holds may not.
inline bool is_whole(const Background& background) {
    const Image& mean = background.mean;
    if (mean.width == 0) return background.counts.empty();
    return mean.channels == 3 && is_whole(mean) &&
           background.counts.size() == mean.values.size() / 3;
}

/// The surroundings of surfaces with unknowns, one entry per pixel of the crop window. Follows from
/// the scene.
struct NearUnknown {
    std::vector<char> pixels;   ///< those whose filter reaches a sample on an unknown
    std::vector<char> samples;  ///< those whose samples reach one of these pixels
};
/// reaching: see reaching_pixels.
NearUnknown near_unknown(const Film& film, const std::vector<char>& reaching);

struct BackgroundOptions {
    std::uint32_t passes = 1;        ///< in an iteration
    std::uint32_t max_passes = 512;  ///< of pixels near unknowns
    std::uint32_t seed = 0;
};

/// Adds this iteration's passes. Returns the number of samples that were not finite.
std::size_t gather_background(const Binding& binding, const NearUnknown& near,
                              const BackgroundOptions& options, std::uint32_t iteration,
                              Background& background);

/// The same in two steps, where several processes share out the tiles of `render_tiles`: what those
/// of a range add, the others being empty, and the background with what all have added, all of its
/// rows. No sums where the iteration has no passes.
struct BackgroundTiles {
    TileImages sums;
    std::size_t rejected = 0;
};
BackgroundTiles trace_background(const Binding& binding, const NearUnknown& near,
                                 const BackgroundOptions& options, std::uint32_t iteration,
                                 const Background& background, const IndexRange& range);
void add_background(const Film& film, const NearUnknown& near, const BackgroundOptions& options,
                    std::uint32_t iteration, const TileImages& sums, Background& background);

/// Some rows of a background.
Background rows_of(const Background& whole, const IndexRange& rows);
/// Adds the rows below.
void join_rows(const Background& below, Background& to);

/// Takes in passes given as their mean. only: non-zero where the passes have sampled a pixel in
/// full, one per pixel; empty: everywhere.
void add_passes(const Image& mean, std::uint32_t passes, std::span<const char> only,
                Background& background);

}  // namespace burnish
