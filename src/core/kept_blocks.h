// Of a long array of floats, the blocks that one of several processes keeps, one behind the other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/dirty_blocks.h"
#include "core/index_range.h"

namespace burnish {

/// Ascending ranges of whole blocks that do not touch. What is kept consists of whole blocks, too,
/// but where the array ends.
struct KeptBlocks {
    std::vector<IndexRange> ranges;

    std::size_t size() const {
        std::size_t floats = 0;
        for (const IndexRange& r : ranges) floats += r.size();
        return floats;
    }
    /// Where float i lies, which is among them.
    std::size_t place_of(std::size_t i) const {
        std::size_t before = 0;
        for (const IndexRange& r : ranges) {
            if (i < r.end) return before + i - r.begin;
            before += r.size();
        }
        return before;
    }
};

/// Those that are flagged, of an array of `floats`.
inline KeptBlocks kept_blocks(const DirtyBlocks& flags, std::size_t floats) {
    KeptBlocks kept;
    for_dirty_intervals(flags, 0, floats, [&](std::size_t begin, std::size_t end) {
        kept.ranges.push_back({begin, end});
    });
    return kept;
}

/// The whole blocks that part `part` of `parts` owns of an array: each as many as the others, or
/// one more. Short arrays are the first one's alone: the others own none, or two blocks at least.
inline IndexRange own_range(std::size_t floats, int part, int parts) {
    const std::size_t blocks = dirty_blocks_in(floats), count = static_cast<std::size_t>(parts);
    if (blocks < 2 * count) return {0, part == 0 ? floats : 0};
    const auto at = [&](int p) {
        return std::min(floats, blocks * static_cast<std::size_t>(p) / count * kDirtyBlock);
    };
    return {at(part), at(part + 1)};
}

}  // namespace burnish
