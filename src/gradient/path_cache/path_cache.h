// The path cache: the records of the last passes, shaded again in each iteration under its
// textures.
//
//   trace       camera samples -> the packed records of a pass, in one of two halves
//   shade       records of a half + theta -> its image                     I_A, I_B
//   loss        both images -> their adjoints                              dL/dI_A, dL/dI_B
//   accumulate  records of a half + theta + the adjoint of the *other* half -> gradient
//
// The gradient is the mean of adjoint(A) x derivative(B) and adjoint(B) x derivative(A). The halves
// draw from independent streams, so each product is one of independent factors: unbiased along any
// script of textures, for a loss whose adjoint is affine in I. One record serves an image and a
// gradient, in every iteration of its life; no ray is traced twice.
//
// A cache may hold some bands of a view alone. Between shade and loss, the sums of its tiles then
// have to be joined with those of the others.
//
// A half is a window on its last passes. When a run optimises, the textures depend on the records
// that moved them: unbiased is the gradient along a script of textures, not that of a closed loop.
#pragma once

#include <algorithm>
#include <array>
#include <deque>

#include "gradient/bands.h"
#include "gradient/binding.h"
#include "gradient/split_gradient.h"
#include "gradient/texel_sums.h"
#include "render/pass_convolution.h"

namespace burnish {

/// The records of one pass.
struct CachedPass {
    std::uint32_t film_pass = 0;  ///< within its half: names the film offset
    /// Parallel to PathCacheWorkspace::tiles; those of other bands than its own are empty.
    std::vector<TileRecords> tiles;

    friend bool operator==(const CachedPass&, const CachedPass&) = default;
};

struct CacheHalf {
    std::deque<CachedPass> passes;    ///< oldest first
    std::uint32_t passes_traced = 0;  ///< so far

    friend bool operator==(const CacheHalf&, const CacheHalf&) = default;
};

/// What the next iteration reads: values only.
struct PathCacheState {
    std::array<CacheHalf, 2> halves;

    friend bool operator==(const PathCacheState&, const PathCacheState&) = default;
};

/// The pixels of a tile of the film that light from an unknown can reach, in the order of tracing,
/// and the box about them.
struct CacheTile {
    Tile tile;
    std::vector<std::uint32_t> pixels;
};

/// Those of a film that are not empty. reaching: reaching_pixels.
std::vector<CacheTile> make_cache_tiles(const Film& film, const std::vector<char>& reaching);

/// Where the derivatives are summed, without memory for a band yet. Of a coloured texture that is
/// read as scalars alone, only the luminance counts: one channel instead of three.
std::vector<TexelSums> make_texel_sums(const Binding& binding);

/// What lies beside a pass.
struct PassMemory {
    std::uint32_t film_pass = 0;
    std::vector<RecordMemory> tiles;  ///< parallel to CachedPass::tiles
};

/// What the records of a cache are shaded for.
enum class CacheUse {
    kImageAndGradient,
    kImage,  ///< derivatives are neither found nor kept
};

/// The gradient of bands that are a node of the tree over them.
struct BandGradient {
    IndexRange bands = kAllBands;
    std::vector<SplitGradient> gradient;  ///< parallel to theta.textures
};

/// Work memory: follows from the scene, the options and the state.
struct PathCacheWorkspace {
    CacheUse use = CacheUse::kImageAndGradient;
    IndexRange bands = kAllBands;  ///< that are its own
    std::vector<CacheTile> tiles;  ///< those that see an unknown
    FilmNormalization normalization;
    std::uint32_t window = 1;                      ///< passes that a half keeps
    std::array<std::deque<PassMemory>, 2> memory;  ///< parallel to CacheHalf::passes
    /// Of each of these bands, from the first call on; zero between calls.
    std::vector<TexelSums> sums;
    /// The last one, one half from each half: of the nodes that its bands fill.
    std::vector<BandGradient> gradient;
};

/// The tiles of its bands.
inline IndexRange own_tiles(const PathCacheWorkspace& workspace) {
    return tiles_of(workspace.bands, workspace.tiles.size());
}

/// The work memory of an empty cache of some bands. Throws ResourceError where PathCache::max_bytes
/// holds less than one pass in each half.
PathCacheWorkspace make_workspace(const PathCache& options, const Binding& binding,
                                  CacheUse use = CacheUse::kImageAndGradient,
                                  const IndexRange& bands = kAllBands);
/// reaching: reaching_pixels, where they are known already.
PathCacheWorkspace make_workspace(const PathCache& options, const Binding& binding,
                                  const std::vector<char>& reaching, CacheUse use,
                                  const IndexRange& bands);

/// What the stages read besides the cache. `binding` must outlive the calls.
struct PathCacheInput {
    const Binding& binding;
    std::uint32_t seed = 0;
    Sequence sequence = Sequence::kSobol;  ///< of the passes of a half, all of them
};

/// Traces one pass into a half, its BSDFs sampled under theta. Returns the number of samples that
/// were not finite.
std::size_t trace_pass(const PathCacheInput& input, std::size_t half,
                       const PathCacheWorkspace& workspace, PathCacheState& state);

/// Traces so many passes into the halves in turn; at least one into each, as long as they are
/// empty. Returns the number of samples that were not finite.
std::size_t trace_passes(const PathCacheInput& input, std::uint32_t passes,
                         const PathCacheWorkspace& workspace, PathCacheState& state);

/// The passes that an iteration traces: so many, but no more than two halves of a window keep.
inline std::uint32_t fresh_passes(std::uint32_t samples, std::uint32_t window) {
    return std::min(samples, 2 * window);
}

/// Of each half, oldest first.
using DroppedPasses = std::array<std::vector<CachedPass>, 2>;
/// Moves the oldest passes of both halves behind those of `dropped` until each has at most
/// `window`. Where memory ends, it has moved none.
void keep_window(std::size_t window, PathCacheState& state, DroppedPasses& dropped);
inline void keep_window(std::size_t window, PathCacheState& state) {
    DroppedPasses dropped;
    keep_window(window, state, dropped);
}

/// Where a path cache was: passes that it held and has traced, by halves.
struct PathCacheMark {
    std::array<std::size_t, 2> passes{};
    std::array<std::uint32_t, 2> passes_traced{};
};
PathCacheMark mark(const PathCacheState& state);
/// Back to a mark. dropped: by keep_window since then.
void roll_back(const PathCacheMark& mark, DroppedPasses dropped, PathCacheState& state);

/// The part of the image that depends on theta, from each half.
struct HalfImages {
    std::array<Image, 2> images;  ///< [crop_height, crop_width, 3]
    std::size_t rejected = 0;     ///< records left out: the value or a derivative was not finite
};

/// The derivatives of the records' values are found on the way and kept in the work memory, unless
/// the cache is for images alone.
HalfImages shade(const PathCacheInput& input, const PathCacheState& state,
                 PathCacheWorkspace& workspace);

/// The same in two steps: what the tiles of its bands add to each image, the others being empty,
/// and an image from what all tiles add.
struct HalfTiles {
    std::array<TileImages, 2> halves;  ///< parallel to PathCacheWorkspace::tiles
    std::size_t rejected = 0;          ///< as of HalfImages
};
HalfTiles shade_tiles(const PathCacheInput& input, const PathCacheState& state,
                      PathCacheWorkspace& workspace);
Image half_image(const Film& film, const CacheHalf& half, const PathCacheWorkspace& workspace,
                 const TileImages& sums);

/// dL / d(texture), parallel to theta.textures, at the theta of the last `shade`; a half from the
/// derivatives of each half. adjoints: dL/dI of the image of each half. The result lies in the work
/// memory, until the next call. Needs CacheUse::kImageAndGradient.
const std::vector<BandGradient>& accumulate_bands(const PathCacheInput& input,
                                                  const PathCacheState& state,
                                                  const std::array<const Image*, 2>& adjoints,
                                                  PathCacheWorkspace& workspace);
/// Of a cache that has all bands.
const std::vector<SplitGradient>& accumulate(const PathCacheInput& input,
                                             const PathCacheState& state,
                                             const std::array<const Image*, 2>& adjoints,
                                             PathCacheWorkspace& workspace);

/// Records in both halves, and the bytes that they take.
struct PathCacheSize {
    std::size_t records = 0, bytes = 0;
};
PathCacheSize size_of(const PathCacheState& state, const PathCacheWorkspace& workspace);

/// What a cache takes at most, known before anything is traced.
struct PathCachePlan {
    std::size_t pixels = 0;  ///< that light from an unknown can reach
    /// If both samples of every camera sample carried light; where light bounces an estimate, a
    /// quarter above the mean of a trial.
    std::size_t bytes_per_pass = 0;
    std::uint32_t window = 1;  ///< passes that each half keeps
};

/// The window is PathCache::window, or less where both halves would take more than max_bytes.
/// Throws ResourceError where one pass in each half does. reaching: reaching_pixels.
PathCachePlan plan(const PathCache& options, const Binding& binding, CacheUse use,
                   const std::vector<char>& reaching);
/// A plan that was made without a limit, the same way within one; 0: none.
PathCachePlan within(PathCachePlan plan, std::size_t max_bytes);

/// The random numbers of a half.
inline RandomKey half_key(const PathCacheInput& input, std::size_t half) {
    return {input.seed, half == 0 ? Stream::kCacheA : Stream::kCacheB};
}

}  // namespace burnish
