// What an iteration with reuse leaves to the next one.
#pragma once

#include <vector>

#include "gradient/candidates.h"

namespace burnish {

/// A reservoir that survived an iteration.
struct HistorySample {
    TexelKey key;
    float q = 0;  ///< target value under the theta and the adjoint of its iteration
    float W = 0;
    PathSample path;
    PathRecord record;
    Hit hit = {};  ///< of the path's primary ray; of direct light

    friend bool operator==(const HistorySample&, const HistorySample&) = default;
};

/// The reservoirs of an iteration, and the integrand under which they were made.
struct History {
    std::vector<HistorySample> samples;  ///< sorted by key; at most two per key
    float confidence = 0;                ///< the same for every texel, hit or not
    Theta theta;                         ///< clamped, as it was rendered
    Image normalized_adjoint;
    PathVertices others = {};  ///< of the samples' paths, where `keeps_vertices`

    friend bool operator==(const History&, const History&) = default;
};

}  // namespace burnish
