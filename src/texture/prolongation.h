// How a level of a pyramid reads the next coarser one, which is half as large (rounded up). A texel
// reads none of another chart's.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/dirty_blocks.h"
#include "image/image.h"
#include "texture/charts.h"
#include "texture/level_taps.h"

namespace burnish {

/// Width or height of the next coarser level.
inline int half(int size) { return (size + 1) / 2; }

/// The charts of the next coarser level: the one that most of the four texels under a coarse one
/// belong to; of several the first; 0 where they belong to none. width, height: of the fine level.
ChartMap halve(const ChartMap& charts, int width, int height);

/// The texels of a fine level, [height, width], that read texels of other charts than their own.
/// Those of no chart read all: nothing is known of them, and nothing reads them.
ChartBorders find_borders(const Prolongation& prolongation, const ChartMap& charts,
                          const ChartMap& coarse_charts, int width, int height);

/// The floats [begin, end), whole texels, of `coarse` prolonged to a level of fine_width. fine:
/// from `begin` on. coarse: of one or three channels, like all images here. row: work memory, kept
/// for the next call.
void prolong(const Prolongation& prolongation, const ChartBorders& borders, const Image& coarse,
             int fine_width, std::size_t begin, std::size_t end, std::vector<float>& row,
             float* fine);

/// Calls body(begin, end, coarse) for intervals of the flagged floats of a level in [begin, end);
/// all, where flags are empty. coarse: the next coarser level prolonged to them; null where there
/// is none. At most kParallelFloats, so that a step of the optimiser asks for no memory for them.
template <class Body>
void for_prolonged(const Prolongation& prolongation, const ChartBorders& borders, int width,
                   const Image* coarser, std::span<const char> flags, std::size_t begin,
                   std::size_t end, const Body& body) {
    std::array<float, kParallelFloats> coarse;
    std::vector<float> row;
    for_dirty_intervals(flags, begin, end, [&](std::size_t from, std::size_t to) {
        if (!coarser) return body(from, to, nullptr);
        prolong(prolongation, borders, *coarser, width, from, to, row, coarse.data());
        body(from, to, coarse.data());
    });
}

/// Sets the flags of the blocks of `fine` that may read the floats [begin, end), whole texels, of
/// the level `coarse`.
void mark_readers(const Prolongation& prolongation, const Image& coarse, std::size_t begin,
                  std::size_t end, const Image& fine, DirtyBlocks& flags);

}  // namespace burnish
