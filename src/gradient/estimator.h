// Estimators as peers: two calls advance any of them by an iteration.
//
//   estimate_image      theta -> the image that depends on theta, one or two independent ones
//   estimate_gradient   dL/dI of each image -> dL/d theta
//
// Between the two the caller adds the background and asks the loss. The images' samples and the
// derivatives that their adjoints weigh are independent, so the gradient is unbiased for a loss
// whose derivative is affine in I [PR sec. 2.2].
#pragma once

#include <optional>
#include <span>
#include <variant>

#include "gradient/monte_carlo.h"
#include "gradient/path_cache/path_cache.h"
#include "gradient/reservoirs/reservoirs.h"

namespace burnish {

/// What an estimator keeps from one iteration to the next: values only. The alternatives are
/// parallel to those of Estimator.
using EstimatorState = std::variant<PathCacheState, ReservoirsState, MonteCarloState>;

/// The path cache that an estimator keeps: PathCache itself, or that of the image of another one.
struct KeptCache {
    PathCache options;
    CacheUse use = CacheUse::kImageAndGradient;
};
/// None: the estimator's images are those of fresh samples alone.
std::optional<KeptCache> kept_cache(const Estimator& estimator);
/// The records of that path cache; of a state without one it is empty.
PathCacheState& kept_cache(EstimatorState& state);

/// Work memory, which follows from scene, options and state.
struct EstimatorWorkspace {
    PathCacheWorkspace cache;              ///< of the path cache that is kept
    std::vector<SplitGradient> gradient;   ///< of all but PathCache
    DroppedPasses dropped = {};            ///< of the path cache, since the last mark
    std::optional<History> replaced = {};  ///< of reservoirs, since the last mark
};

/// Where a state was before an iteration.
struct EstimatorMark {
    PathCacheMark cache;
    PixelStatistics pixels;
};
/// What visits drop from then on is kept in the work memory, until `release`.
EstimatorMark mark(EstimatorState& state);
/// Back to the mark before the iteration, whether its visits have ended or not.
void roll_back(EstimatorMark mark, EstimatorState& state, EstimatorWorkspace& workspace);
/// The iteration has ended.
inline void release(EstimatorWorkspace& workspace) {
    workspace.dropped = {}, workspace.replaced.reset();
}

/// The state before the first iteration.
EstimatorState make_state(const Estimator& estimator);
/// bands: of the view, that are this process's; all, unless shares_bands holds.
/// reaching: reaching_pixels of the view.
EstimatorWorkspace make_workspace(const Estimator& estimator, const Binding& binding,
                                  const std::vector<char>& reaching,
                                  const IndexRange& bands = kAllBands);

/// What names an iteration's random numbers.
struct IterationKey {
    std::uint32_t seed = 0, iteration = 0;
};

/// Whether the images of an estimator must be two where it could make one.
enum class Images { kAny, kHalves };

struct ImageEstimate {
    /// One image, or two from independent halves of the samples; [crop_height, crop_width, 3],
    /// without what no unknown reaches.
    std::vector<Image> images;
    std::size_t rejected_samples = 0;  ///< not finite, when traced
    std::size_t rejected_records = 0;  ///< not finite, when shaded again
};
ImageEstimate estimate_image(const Estimator& estimator, const Binding& binding, IterationKey key,
                             EstimatorState& state, EstimatorWorkspace& workspace,
                             Images images = Images::kAny);

/// Whether several processes can share out the bands of a view.
inline bool shares_bands(const Estimator& e) { return std::holds_alternative<PathCache>(e); }
/// The same of the estimator that keeps the state.
inline bool shares_bands(const EstimatorState& s) {
    return std::holds_alternative<PathCacheState>(s);
}

/// estimate_image in two steps, where several processes share out the bands of a view: what the
/// tiles of one's own add to the images, and the images, once those of all are there.
struct ImageTiles {
    std::array<TileImages, 2> halves;  ///< of each image; empty: another process's
    std::size_t rejected_samples = 0;  ///< as of ImageEstimate, and so are:
    std::size_t rejected_records = 0;
};
ImageTiles estimate_tiles(const Estimator& estimator, const Binding& binding, IterationKey key,
                          EstimatorState& state, EstimatorWorkspace& workspace);
std::vector<Image> images_of_tiles(const Film& film, const std::array<TileImages, 2>& halves,
                                   const EstimatorState& state,
                                   const EstimatorWorkspace& workspace);

/// The gradient, and what is reported of it.
struct GradientEstimate {
    /// dL / d(texture), parallel to theta.textures; in the work memory, until the next call. In
    /// halves where has_split_gradient.
    const std::vector<SplitGradient>& gradient;
    GradientCounts counts;
    /// Of a process that has some bands of a view: all that it brings. `gradient` is then that of
    /// the first.
    std::span<const BandGradient> bands = {};
};

/// adjoints: dL/dI of each image of this iteration's estimate_image, or one that serves all. An
/// estimator whose derivatives are not those of its image's samples (`has_own_derivatives`) reads
/// the first alone, and needs no estimate_image before.
GradientEstimate estimate_gradient(const Estimator& estimator, const Binding& binding,
                                   std::span<const Image> adjoints, IterationKey key,
                                   EstimatorState& state, EstimatorWorkspace& workspace);

bool has_own_derivatives(const Estimator& estimator);
/// Whether its gradients come in halves.
inline bool has_split_gradient(const Estimator& e) { return std::holds_alternative<PathCache>(e); }

/// Samples per pixel of the image in an iteration; a path cache traces fresh_passes of them.
std::uint32_t image_samples(const Estimator& estimator);

}  // namespace burnish
