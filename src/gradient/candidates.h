// Fresh samples of the derivative: traced, differentiated and grouped by the texel that they reach.
#pragma once

#include <vector>

#include "gradient/adaptive_sampling.h"
#include "gradient/candidate.h"
#include "gradient/differentiate.h"
#include "gradient/outliers.h"

namespace burnish {

/// The parameter-space integrand g of one iteration [PR eq. 5, 14]: textures, adjoint, and how to
/// trace under them. Views: what they refer to must outlive it.
struct Integrand {
    DerivativeInput derivative;
    TraceInput trace;
};

/// Where fresh samples of the derivative go.
struct Sampling {
    std::uint32_t samples_per_pixel = 1;  ///< m, at least 1
    bool adaptive = false;                ///< see adaptive_sampling.h
    std::uint32_t seed = 0;
    /// Where light bounces: paths to one light each, with all of their vertices
    /// (paths/light_paths.h), in place of samples that hold the rest of their path.
    bool keep_vertices = false;
};

/// The film passes that an iteration's samples may take.
std::uint32_t passes_per_iteration(const Sampling& sampling);

/// The filter's taps of an iteration's passes.
PassTaps derivative_taps(const Binding& binding, const Sampling& sampling, std::uint32_t iteration);
/// The first film pass of an iteration.
inline std::uint32_t first_pass(const Sampling& sampling, std::uint32_t iteration) {
    return iteration * passes_per_iteration(sampling);
}

/// normalized_adjoint: dL/dI divided by the integral of h_j.
Integrand make_integrand(const Binding& binding, const Image& normalized_adjoint,
                         const PassTaps& taps, const Sampling& sampling, TargetFunction target);

/// A path with its name and what was kept of it.
struct TracedPath {
    PathSample path;
    PathRecord record;
    Hit hit = {};     ///< of the primary ray; of direct light
    float share = 1;  ///< 1 / e_j: what its sample counts for in its iteration's estimate
};

/// Camera samples that tell how much light others will carry, at most so many: spread evenly over
/// the pixels that are marked.
std::vector<BatchSample> trial_samples(std::span<const char> pixels, std::size_t max_samples);
/// Room to spare above what a trial finds of paths whose length has no bound.
inline constexpr double kTrialMargin = 1.25;

/// Paths that were traced, in a fixed order.
struct TracedPaths {
    std::vector<TracedPath> paths;
    /// Of paths to one light each (paths/light_paths.h), else empty: the vertices of their chains,
    /// f under the textures of tracing as `scattered` finds it, and where each path lies.
    std::vector<ChainVertex> chains;
    std::vector<ChainPlace> places;  ///< parallel to `paths`
    std::size_t rejected = 0;        ///< samples that were not finite
};

/// All samples of the passes of an iteration that meet an unknown. vertices_under: where light
/// bounces, these become paths to one light each, with f of their vertices under its textures,
/// which must be those that `input` traces under; null: samples that hold the rest of their path.
TracedPaths trace_paths(const TraceInput& input, std::uint32_t iteration, std::uint32_t passes,
                        const Binding* vertices_under = nullptr);

/// The same for camera samples that were chosen otherwise; neighbours should follow one another.
TracedPaths trace_paths(const TraceInput& input, std::span<const BatchSample> samples,
                        const Binding* vertices_under = nullptr);

/// The records of named paths under the textures of `input`, in the order of `paths`; black where a
/// path fails; by this thread alone. rejected: grows by those that are not finite.
std::vector<PathRecord> trace_again(const TraceInput& input, std::span<const PathSample> paths,
                                    std::size_t& rejected);

/// The same records of paths whose light arrived under other textures, whose primary rays have
/// these hits. Where light does not bounce, no ray is traced for what no texture changes: see
/// replay_batch. records: of the paths under other textures.
std::vector<PathRecord> replay_paths(const TraceInput& input, std::span<const PathSample> paths,
                                     std::span<const Hit> hits, std::vector<PathRecord> records,
                                     std::size_t& rejected);

struct Candidates {
    TracedPaths traced;
    std::vector<Candidate> items;      ///< sorted by (texel, path)
    std::vector<PixelSquare> squares;  ///< parallel to traced.paths
    Outlier largest;                   ///< derivative
    std::size_t rejected = 0;          ///< samples and derivatives that were not finite
};

/// The derivatives of traced paths.
Candidates make_candidates(const DerivativeInput& input, TracedPaths traced);

/// The candidates of an iteration's fresh samples. statistics: of adaptive sampling; takes them in.
Candidates draw_candidates(const Integrand& integrand, std::uint32_t iteration,
                           const Sampling& sampling, PixelStatistics& statistics);

}  // namespace burnish
