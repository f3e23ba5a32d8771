// The transpose of prolongation: the gradient by a level becomes that by the next coarser one.
#pragma once

#include "gradient/split_gradient.h"
#include "texture/prolongation.h"

namespace burnish {

/// Each value of either half becomes the weighted sum of the fine texels that read it. coarse: its
/// memory is kept from call to call.
void restrict_gradient(const Prolongation& prolongation, const ChartBorders& borders,
                       const SplitGradient& fine, SplitGradient& coarse);

}  // namespace burnish
