// Scene + textures -> image: traces passes in tiles and reconstructs them on the film.
#pragma once

#include <cstdint>
#include <span>

#include "burnish/renderer.h"
#include "core/index_range.h"
#include "image/image.h"
#include "paths/trace.h"
#include "render/pass_convolution.h"

namespace burnish {

struct RenderCounts {
    std::size_t rejected = 0;  ///< contributions to samples left out, not finite
};

/// The largest share of samples or contributions that may be left out, not finite: else values are
/// too large.
inline constexpr double kMaxRejectedShare = 1e-3;

/// Throws InputError where more of `all` were left out. what: "samples"; reason: how the message
/// ends.
void require_few_rejected(std::size_t rejected, std::size_t all, const char* what,
                          const char* reason);

/// The image of the crop window as the mean of `passes` passes of an iteration: [crop_height,
/// crop_width, 3], linear RGB radiance. Only samples whose surface input.choice admits contribute
/// (the whole image is that of kConstant plus that of kUnknown: the film is linear). The same bytes
/// for any number of threads.
Image render(const TraceInput& input, std::uint32_t iteration, std::uint32_t passes,
             RenderCounts* counts = nullptr, const Progress& progress = {});

/// Passes [first, first + count) of an iteration.
struct Passes {
    std::uint32_t iteration = 0, first = 0, count = 0;
    std::span<const char> only = {};  ///< non-zero where a pixel is sampled; empty: everywhere
};

/// The same in two steps, for processes that share out the tiles of an image: what those of `range`
/// add to it, the others being empty, and the image of what all have made. progress: of the range.
std::size_t tile_count(const Film& film);
TileImages render_tiles(const TraceInput& input, const Passes& passes, const IndexRange& range,
                        RenderCounts* counts = nullptr, const Progress& progress = {});
Image image_of_tiles(const Film& film, std::uint32_t passes, const TileImages& sums);

/// The alpha of such an image, [crop_height, crop_width, 1]: the share of the camera's samples that
/// meet a surface, or, without Scene::direct_alpha, see an environment that is not hidden: see
/// trace_coverage. By the weights that the samples have, not by their integral: where every sample
/// does, it is 1.
Image render_alpha(const TraceInput& input, std::uint32_t passes);

}  // namespace burnish
