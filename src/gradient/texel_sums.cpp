#include "gradient/texel_sums.h"

#include <algorithm>
#include <array>
#include <bit>
#include <new>

#include "core/parallel.h"

namespace burnish {

namespace {

/// A block of three channels.
using BlockSum = std::array<float, 3 * kBlockTexels>;

/// A block's floats in a band, in the channels of the image.
void copy_block(const TexelSums& sums, const float* from, BlockSum& to) {
    if (!sums.of_luminance) {
        std::copy_n(from, kBlockTexels * sums.channels, to.data());
        return;
    }
    for (std::size_t i = 0; i < kBlockTexels; ++i)
        for (std::size_t c = 0; c < 3; ++c) to[3 * i + c] = kLuminanceWeights[c] * from[i];
}

/// The sum of a block over bands [begin, begin + size), by halves; false: none has dirtied it.
bool sum_block(const TexelSums& sums, std::size_t block, std::size_t begin, std::size_t size,
               BlockSum& sum) {
    if (size == 1) {
        const TexelBand& band = sums.bands[begin];
        if (!band.dirty[block]) return false;
        copy_block(sums, band.values.get() + block * kBlockTexels * sums.channels, sum);
        return true;
    }
    const std::size_t half = std::bit_ceil(size) / 2;
    if (!sum_block(sums, block, begin, half, sum))
        return sum_block(sums, block, begin + half, size - half, sum);
    BlockSum second;
    if (sum_block(sums, block, begin + half, size - half, second))
        for (std::size_t i = 0; i < kBlockTexels * static_cast<std::size_t>(out_channels(sums));
             ++i)
            sum[i] += second[i];
    return true;
}

}  // namespace

TexelSums make_texel_sums(int width, int height, int channels, std::size_t bands) {
    TexelSums sums;
    sums.width = static_cast<std::uint32_t>(width),
    sums.height = static_cast<std::uint32_t>(height);
    sums.channels = static_cast<std::uint32_t>(channels);
    sums.blocks_x = (sums.width + kTexelBlock - 1) / kTexelBlock;
    reserve_bands(bands, sums);
    return sums;
}

void reserve_bands(std::size_t bands, TexelSums& sums) {
    const std::size_t blocks = block_count(sums);
    while (sums.bands.size() < bands) {
        TexelBand band;
        band.values.reset(static_cast<float*>(
            std::calloc(blocks * kBlockTexels, sizeof(float) * std::size_t{sums.channels})));
        if (!band.values) throw std::bad_alloc();
        band.dirty.assign(blocks, 0);
        sums.bands.push_back(std::move(band));
    }
}

void fold(TexelSums& sums, const IndexRange& bands, Image& image, DirtyBlocks& dirty) {
    const std::size_t block_floats = kBlockTexels * sums.channels;
    const auto channels = static_cast<std::size_t>(image.channels);
    parallel_for(sums.bands.front().dirty.size(), [&](std::size_t block) {
        BlockSum sum;
        if (!sum_block(sums, block, bands.begin, bands.size(), sum)) return;
        for (std::size_t b = bands.begin; b < bands.end; ++b) {
            TexelBand& band = sums.bands[b];
            if (!band.dirty[block]) continue;
            std::fill_n(band.values.get() + block * block_floats, block_floats, 0.0f);
            band.dirty[block] = 0;
        }
        const auto x0 = static_cast<std::uint32_t>(block % sums.blocks_x) * kTexelBlock;
        const auto y0 = static_cast<std::uint32_t>(block / sums.blocks_x) * kTexelBlock;
        const std::size_t wide = std::min(kTexelBlock, sums.width - x0);
        const std::uint32_t high = std::min(kTexelBlock, sums.height - y0);
        for (std::uint32_t y = 0; y < high; ++y) {
            const std::size_t at = image.index(static_cast<int>(x0), static_cast<int>(y0 + y));
            mark_dirty(dirty, at, at + wide * channels);
            std::copy_n(&sum[std::size_t{y} * kTexelBlock * channels], wide * channels,
                        &image.values[at]);
        }
    });
}

}  // namespace burnish
