// Counts of contributions over many estimates: how many, how many were not finite, and which stood
// out.
#pragma once

#include <string>
#include <vector>

#include "gradient/reservoirs/reservoirs.h"

namespace burnish {

/// A contribution that stands out, and the iteration in which it came.
struct NamedOutlier {
    Outlier contribution;
    std::uint32_t iteration = 0;
};

struct ContributionCounts {
    std::size_t records = 0, candidates = 0;
    std::size_t rejected = 0;  ///< contributions that were not finite
    /// At most kMaxOutliers, largest first, each of pixel, texel and technique once: the record of
    /// a pool comes again in every iteration that keeps it.
    std::vector<NamedOutlier> outliers;
};

void add_counts(ContributionCounts& counts, const GradientCounts& more, std::uint32_t iteration);

/// "12.3 at pixel (4, 5) to texel (6, 7) of NAME by the emitter technique in iteration 8"
std::string describe(const NamedOutlier& outlier, const Scene& scene, const Theta& theta);

/// The name of the first parameter that reads a texture.
std::string parameter_name(const Scene& scene, TextureId texture);

const char* name_of(Technique technique);

}  // namespace burnish
