// One step of what the optimiser moves: of all of a pyramid, or of the part of one process of
// several, to the same bytes.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "gradient/split_gradient.h"
#include "texture/pyramid_part.h"

namespace burnish {

/// Work memory of a level.
struct LevelWorkspace {
    SplitGradient gradient;  ///< by LevelPart::read of this level, but of the finest
    Image sum;               ///< of this and all coarser levels, but of the finest
    DirtyBlocks dirty;       ///< where that sum may have changed since the start
    DirtyBlocks propagated;  ///< of `dirty`: those of which the next finer level knows
};

/// Work memory: follows from the state.
struct PyramidWorkspace {
    std::vector<LevelWorkspace> levels;
};

/// An array of which some blocks have moved.
struct MovedFloats {
    std::vector<float>& values;
    DirtyBlocks& dirty;
};

/// What the parts of a pyramid say to each other during a step. Empty: there is one part.
struct PartExchange {
    /// Makes values the sums over the parts.
    std::function<void(std::span<double> values)> add_up = {};
    /// Gives the others the dirty blocks of this part's own range of each array, and takes theirs,
    /// which become dirty.
    std::function<void(const std::vector<MovedFloats>& arrays)> share_moved = {};
};

/// What a step goes by.
struct PyramidStep {
    const AdamOptions& options;
    const PyramidMaps& maps;
    const PyramidPart& part;
    const PartExchange& exchange;
};

/// One step. Weight decay acts on all levels but the coarsest; a single level is that.
/// gradient: by LevelPart::read of the finest level. texture: all of it, the one of the state
/// before, becomes the one after, clamped to [0, 1].
void descend(const PyramidStep& step, const SplitGradient& gradient, PyramidState& state,
             PyramidWorkspace& workspace, Image& texture);

}  // namespace burnish
