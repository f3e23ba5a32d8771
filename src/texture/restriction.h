// The transpose of prolongation: the gradient by a level becomes that by the next coarser one.
#pragma once

#include "core/kept_blocks.h"
#include "gradient/split_gradient.h"
#include "texture/prolongation.h"

namespace burnish {

/// A level of a gradient, of which some blocks are kept.
struct KeptLevel {
    Vec2<int> size;  ///< width and height
    int channels = 1;
    const KeptBlocks& kept;
};

/// Each value of either half becomes the weighted sum of the fine texels that read it. Both
/// gradients hold the kept blocks of their levels: the fine one all rows that read a kept float of
/// the coarse level. coarse: its memory is kept from call to call.
void restrict_gradient(const Prolongation& prolongation, const ChartBorders& borders,
                       const KeptLevel& fine_level, const SplitGradient& fine,
                       const KeptLevel& coarse_level, SplitGradient& coarse);

}  // namespace burnish
