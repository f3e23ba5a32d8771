// Long arrays of floats of which large parts are zero or stay as they are: one flag for each
// block, so that passes over the array leave these parts out.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace burnish {

/// Floats of a block: whole texels of one or three channels and whole vector registers.
inline constexpr std::size_t kDirtyBlock = 48;

/// Floats that a thread works on at once: they stay in the cache.
inline constexpr std::size_t kParallelFloats = 256 * kDirtyBlock;

/// One flag per block of an array.
using DirtyBlocks = std::vector<char>;

inline std::size_t dirty_blocks_in(std::size_t floats) {
    return (floats + kDirtyBlock - 1) / kDirtyBlock;
}

/// Sets the flags of the blocks that floats [begin, end) lie in, end > begin. Threads may do so
/// at once.
inline void mark_dirty(DirtyBlocks& flags, std::size_t begin, std::size_t end) {
    for (std::size_t s = begin / kDirtyBlock; s <= (end - 1) / kDirtyBlock; ++s)
        std::atomic_ref(flags[s]).store(1, std::memory_order_relaxed);
}

/// Whether any of `count` floats is other than zero.
inline bool any_nonzero(const float* from, std::size_t count) {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < count; ++i) bits |= std::bit_cast<std::uint32_t>(from[i]);
    return bits << 1 != 0;  // zeros may have a sign
}

/// Calls body(begin, end) for each longest interval of floats of [begin, end) whose blocks are
/// set. flags: empty where all are.
template <class Body>
void for_dirty_intervals(std::span<const char> flags, std::size_t begin, std::size_t end,
                         const Body& body) {
    if (flags.empty() && begin < end) return body(begin, end);
    while (begin < end) {
        std::size_t s = begin / kDirtyBlock;
        const std::size_t last = dirty_blocks_in(end);
        while (s < last && !flags[s]) ++s;
        const std::size_t from = std::max(begin, s * kDirtyBlock);
        while (s < last && flags[s]) ++s;
        begin = std::min(end, s * kDirtyBlock);
        if (from < begin) body(from, begin);
    }
}

}  // namespace burnish
