// Fresh samples of the derivative: traced, differentiated and grouped by the texel that they touch.
#pragma once

#include <vector>

#include "gradient/reservoirs/reservoirs.h"

namespace burnish {

/// A path with its name and what was kept of it.
struct TracedPath {
    PathSample path;
    PathRecord record;
    float share = 1;  ///< 1 / e_j: what its sample counts for in its iteration's estimate
};

/// All draws of the passes of an iteration that meet an optimised texture, in a fixed order.
std::vector<TracedPath> trace_paths(const TraceInput& input, std::uint32_t iteration,
                                    std::uint32_t passes, std::size_t& rejected);

/// The same for camera samples that were chosen otherwise; neighbours should follow one another.
std::vector<TracedPath> trace_paths(const TraceInput& input, std::span<const BatchSample> samples,
                                    std::size_t& rejected);

/// The records of named paths under the textures of `input`, in the order of `paths`; black where a
/// path fails.
std::vector<PathRecord> replay_paths(const TraceInput& input, const std::vector<PathSample>& paths);

/// A path at one texel [PR alg. 2].
struct Candidate {
    TexelDerivative d;
    std::uint32_t path = 0;  ///< index into the traced paths
};

struct Candidates {
    std::vector<Candidate> items;  ///< sorted by (texel, path)
    std::size_t rejected = 0;      ///< derivatives that were not finite
    std::vector<Outlier> outliers;
    std::vector<PixelSquare> squares;  ///< parallel to the traced paths
};

Candidates make_candidates(const DerivativeInput& input, const std::vector<TracedPath>& paths);

}  // namespace burnish
