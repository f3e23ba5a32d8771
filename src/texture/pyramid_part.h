// The part of a pyramid that one of several processes steps: a range of floats of each level, with
// what Adam knows of them. The values of the coarser levels are all on each process, those of the
// finest only in its own range.
//
// A process knows the gradient where the texels that it steps read it, on its own level and as the
// transpose of prolongation on all coarser ones: their gradient follows without another message.
#pragma once

#include <cstddef>
#include <vector>

#include "core/kept_blocks.h"
#include "texture/pyramid.h"

namespace burnish {

/// Of a level.
struct LevelPart {
    IndexRange own;   ///< what this part steps
    KeptBlocks read;  ///< where it needs the gradient; own floats are among them
};

/// Finest level first.
using PyramidPart = std::vector<LevelPart>;

/// Part `part` of `parts`; all of it without them.
PyramidPart part_of(const PyramidMaps& maps, int channels, int part = 0, int parts = 1);

/// Makes a whole state that of a part.
void keep_part(PyramidState& state, int part, int parts);

/// The entries of an array that belong to a range of floats, each to `per` of them.
inline IndexRange entries_of(const IndexRange& floats, std::size_t per) {
    return {floats.begin / per, (floats.end + per - 1) / per};
}

/// Calls body(array, floats, per) for each array of which a part keeps its own entries only, if the
/// array has any. floats: of the level; per: how many of them an entry belongs to. The entries of
/// all parts, in order, are the whole. AdamState::initial may be a block that repeats: each part
/// keeps it.
template <class State, class Body>
void for_parted_arrays(State& state, const Body& body) {
    for (std::size_t i = 0; i < state.levels.size(); ++i) {
        auto& level = state.levels[i];
        const std::size_t floats = level.values.index(0, level.values.height);
        if (i == 0) body(level.values.values, floats, 1);
        for (auto* array :
             {&level.adam.mean, &level.adam.square, &level.adam.noise, &level.adam.initial})
            body(*array, floats, 1);
        body(level.adam.roots, floats, kDirtyBlock);
        body(level.adam.visited, floats, kDirtyBlock);
    }
    const Image& finest = state.levels.front().values;
    body(state.visits, finest.index(0, finest.height), static_cast<std::size_t>(finest.channels));
}

}  // namespace burnish
