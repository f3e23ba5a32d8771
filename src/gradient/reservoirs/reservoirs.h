// The gradient of the loss by every texel: the baseline and the resampled estimators, on one code
// path.
//
//   camera samples -> records -> candidates (texel, q, g)      [PR eq. 14, alg. 2]
//   candidates of a texel -> current reservoirs                [PR eq. 11]
//   current + history -> merged reservoirs -> gradient         [PR eq. 12-13, alg. 3]
//
// `mc` sums the candidates instead, `ris` and `pris` stop at the current reservoirs.
#pragma once

#include <string>
#include <vector>

#include "gradient/differentiate.h"
#include "gradient/outliers.h"
#include "gradient/reservoirs/merge.h"
#include "gradient/adaptive_sampling.h"
#include "paths/trace.h"

namespace burnish {

enum class Estimator {
    kMc,     ///< plain sum over the draws: the detached baseline
    kRis,    ///< one reservoir per texel with |q|
    kPris,   ///< one reservoir per texel and sign [PR eq. 11]
    kGris,   ///< kRis with history
    kPgris,  ///< kPris with history: the paper's method [PR eq. 12]
    kPool,   ///< records of many iterations, all shaded again: a descent's, see pool.h
};

inline Signs signs_of(Estimator e) {
    return e == Estimator::kRis || e == Estimator::kGris ? Signs::kAbsolute : Signs::kPositivized;
}
inline bool has_history(Estimator e) { return e == Estimator::kGris || e == Estimator::kPgris; }

/// How a sample of an earlier iteration becomes one of this iteration.
enum class Shift {
    kReplay,    ///< the same random numbers under the current textures: traced anew; the paper's
    kIdentity,  ///< the same path: no ray is traced
};

enum class MergeRule {
    kBalance,    ///< [PR eq. 13]
    kDefensive,  ///< never amplifies history
};

struct GradientOptions {
    Estimator estimator = Estimator::kPgris;
    Shift shift = Shift::kReplay;
    Target target = Target::kLuminance;
    MergeRule merge = MergeRule::kBalance;
    std::uint32_t samples_per_pixel = 1;  ///< m, at least 1
    PixelChoice pixels = PixelChoice::kUniform;
    float confidence_cap =
        16;  ///< M_cap: history counts at most this many candidates per pixel; positive
    std::uint32_t seed = 0;
};

/// Whether an iteration leaves something that the next one reads.
inline bool has_state(const GradientOptions& o) {
    return has_history(o.estimator) || o.pixels == PixelChoice::kAdaptive;
}

/// A reservoir that survived an iteration.
struct HistorySample {
    TexelKey key;
    float q = 0;  ///< target value under the theta and the adjoint of its iteration
    float W = 0;
    PathSample path;
    PathRecord record;
};

/// What the next iteration needs of this one. Serialisable: values only.
struct History {
    std::vector<HistorySample> samples;  ///< sorted by key; at most two per key
    float confidence = 0;                ///< the same for every texel, hit or not
    Theta theta;                         ///< clamped, as it was rendered
    Image normalized_adjoint;
    PixelStatistics pixels;  ///< of PixelChoice::kAdaptive, whatever the estimator
};

struct GradientCounts {
    std::size_t records = 0, candidates = 0, texels = 0, reservoirs = 0;
    std::size_t rejected = 0;                   ///< contributions that were not finite
    std::vector<Outlier> outliers;  ///< the largest, at most kMaxOutliers, largest first
};

struct TexelGradient {
    TexelKey key;
    Rgbf g;  ///< dL / d(texel channels); one-channel textures use x
};

struct GradientResult {
    std::vector<TexelGradient>
        gradient;     ///< sorted by key; texels that are absent have a zero estimate
    History history;  ///< empty where has_state does not hold
    GradientCounts counts;
};

/// One estimate at `theta` for the given adjoint dL/dI [crop_height, crop_width, 3]. `history` is
/// that of the iteration before (empty at first), under the same options. The same bytes for any
/// number of threads. Throws InputError for Estimator::kPool, which shades images of its own.
GradientResult estimate_gradient(const TracedScene& scene, const Theta& theta, const Image& adjoint,
                                 std::uint32_t iteration, const GradientOptions& options,
                                 History history);

/// As images, one per texture of theta, [height, width, channels].
std::vector<Image> dense_gradient(const Theta& theta, const std::vector<TexelGradient>& gradient);

/// Adds a gradient by the texels of one texture to sums of [height, width, channels]: for means
/// over estimates.
void accumulate(const std::vector<TexelGradient>& gradient, int channels, std::vector<double>& sum);

/// Option names as the command line and the reports spell them.
const char* name_of(Estimator e);
const char* name_of(Shift s);

}  // namespace burnish
