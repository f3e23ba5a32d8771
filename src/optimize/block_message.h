// The dirty blocks of arrays, in messages of one process to another.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <vector>

#include "core/archive.h"
#include "core/kept_blocks.h"

namespace burnish {

/// Of arrays that share their flags: each run of dirty blocks of a range, as begin and end, counted
/// from that of the range, and the floats of each array.
inline void put_blocks(const std::vector<const float*>& arrays, const DirtyBlocks& dirty,
                       const IndexRange& range, ArchiveWriter& message) {
    for_dirty_intervals(dirty, range.begin, range.end, [&](std::size_t from, std::size_t to) {
        message(std::uint64_t{from - range.begin}, std::uint64_t{to - range.begin});
        for (const float* array : arrays) message.raw(array + from, (to - from) * sizeof(float));
    });
    message(~std::uint64_t{0});
}

/// Reads what put_blocks wrote into a range as long as the one that they were of. What came becomes
/// dirty. Throws what the message does where blocks lie outside of their range, too.
inline void get_blocks(const std::vector<float*>& arrays, const IndexRange& range,
                       DirtyBlocks& dirty, ArchiveReader& message) {
    std::uint64_t from = 0, to = 0;
    for (message(from); from != ~std::uint64_t{0}; message(from)) {
        message(to);
        if (from >= to || to > range.size())
            message.fail(fmt::format("values {} to {}", from, to),
                         fmt::format("some of {}", range.size()));
        const std::size_t begin = range.begin + from, end = range.begin + to;
        for (float* array : arrays) message.raw(array + begin, (end - begin) * sizeof(float));
        mark_dirty(dirty, begin, end);
    }
}

}  // namespace burnish
