// Sums over texels that many threads add to, the same for any number of threads: a fixed number of
// bands, each worked on by one thread at a time, each with sums of its own, folded by a binary
// tree.
//
// Texels lie in blocks of 32 x 32, a page of memory per channel. A band holds memory only for the
// blocks that it visited, and only those are folded.
#pragma once

#include <array>
#include <cstdlib>
#include <memory>
#include <vector>

#include "core/dirty_blocks.h"
#include "core/index_range.h"
#include "core/packet.h"
#include "image/image.h"

namespace burnish {

inline constexpr std::uint32_t kTexelBlock = 32;
inline constexpr std::size_t kBlockTexels = std::size_t{kTexelBlock} * kTexelBlock;

/// The sums of one band, for one texture.
struct TexelBand {
    struct Free {
        void operator()(float* p) const { std::free(p); }
    };
    std::unique_ptr<float, Free> values;  ///< zero pages of the system until they are written
    std::vector<char> dirty;              ///< per block
};

struct TexelSums {
    std::uint32_t width = 0, height = 0, blocks_x = 0;
    std::uint32_t channels = 1;  ///< 1 or 3
    /// One sum stands for three channels: that by the luminance, which fold spreads over them.
    bool of_luminance = false;
    std::vector<TexelBand> bands;
};

/// Of a band.
inline std::size_t block_count(const TexelSums& sums) {
    return std::size_t{sums.blocks_x} * ((sums.height + kTexelBlock - 1) / kTexelBlock);
}
/// The block of texel (x, y). T: std::uint32_t or LaneIntegers.
template <class T>
T block_of(const TexelSums& sums, const T& x, const T& y) {
    return y / kTexelBlock * sums.blocks_x + x / kTexelBlock;
}

TexelSums make_texel_sums(int width, int height, int channels, std::size_t bands);

/// Makes sums for so many bands, where there are fewer.
void reserve_bands(std::size_t bands, TexelSums& sums);

/// By halves: the same for registers of any width.
inline float sum_of_lanes(const Packet& p) {
    std::array<float, kLanes> lane;
    for (int k = 0; k < kLanes; ++k) lane[static_cast<std::size_t>(k)] = get(p, k);
    for (std::size_t half = kLanes / 2; half > 0; half /= 2)
        for (std::size_t k = 0; k < half; ++k) lane[k] += lane[k + half];
    return lane[0];
}

/// Adds sixteen values to texels (x, y) of a band; one-channel textures take value.x. Those of one
/// texel are added up first: it may get millions, of which a sum of floats would lose a part.
inline void add(const TexelSums& sums, TexelBand& band, const LaneIntegers& x,
                const LaneIntegers& y, const Rgb<Packet>& value) {
    constexpr std::uint32_t kSide = kTexelBlock;
    const LaneIntegers block = block_of(sums, x, y);
    const LaneIntegers texel = block * (kSide * kSide) + y % kSide * kSide + x % kSide;
    float* values = band.values.get();
    char* dirty = band.dirty.data();
    if (all(block == get(block, 0)))  // usually: records of a tile are neighbours
        dirty[get(block, 0)] = 1;
    else
        for (int k = 0; k < kLanes; ++k) dirty[get(block, k)] = 1;
    if (all(texel == get(texel, 0))) {
        float* to = values + sums.channels * std::size_t{get(texel, 0)};
        for (int c = 0; c < static_cast<int>(sums.channels); ++c) to[c] += sum_of_lanes(value[c]);
        return;
    }
    if (sums.channels == 1) {
        for (int k = 0; k < kLanes; ++k) values[get(texel, k)] += get(value.x, k);
        return;
    }
    for (int k = 0; k < kLanes; ++k) {
        float* to = values + 3 * std::size_t{get(texel, k)};
        to[0] += get(value.x, k), to[1] += get(value.y, k), to[2] += get(value.z, k);
    }
}

/// Channels of the image that the sums are folded to.
inline int out_channels(const TexelSums& sums) {
    return sums.of_luminance ? 3 : static_cast<int>(sums.channels);
}

/// Writes the sum of some bands to `image`, [height, width, out_channels], where a band has
/// dirtied it, and sets the flags of the dirty blocks there; clears these bands. They are halved
/// again and again, the first half a power of two: a node is the sum of its halves.
void fold(TexelSums& sums, const IndexRange& bands, Image& image, DirtyBlocks& dirty);
inline void fold(TexelSums& sums, Image& image, DirtyBlocks& dirty) {
    fold(sums, {0, sums.bands.size()}, image, dirty);
}

}  // namespace burnish
