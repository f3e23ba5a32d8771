// A candidate of a texel's gradient, and candidates in the order of the texels.
#pragma once

#include <vector>

#include "gradient/differentiate.h"

namespace burnish {

/// A path at one texel [PR alg. 2].
struct Candidate {
    TexelDerivative d;
    std::uint32_t path = 0;  ///< index into the traced paths
};

/// The candidates of all runs, by texel; those of one texel in the order in which they came. Takes
/// the runs, so that no more than two copies of a candidate exist at a time.
std::vector<Candidate> sort_by_texel(std::vector<std::vector<Candidate>> runs);

}  // namespace burnish
