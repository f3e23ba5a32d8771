#include "gradient/texel_sums.h"

#include <algorithm>
#include <new>

#include "core/parallel.h"

namespace burnish {

TexelSums make_texel_sums(int width, int height, int channels, std::size_t bands) {
    TexelSums sums;
    sums.width = static_cast<std::uint32_t>(width),
    sums.height = static_cast<std::uint32_t>(height);
    sums.channels = static_cast<std::uint32_t>(channels);
    sums.blocks_x = (sums.width + kTexelBlock - 1) / kTexelBlock;
    const std::size_t blocks =
        std::size_t{sums.blocks_x} * ((sums.height + kTexelBlock - 1) / kTexelBlock);
    sums.bands.resize(bands);
    for (TexelBand& band : sums.bands) {
        band.values.reset(
            static_cast<float*>(std::calloc(blocks * kTexelBlock * kTexelBlock,
                                            sizeof(float) * static_cast<std::size_t>(channels))));
        if (!band.values) throw std::bad_alloc();
        band.dirty.assign(blocks, 0);
    }
    return sums;
}

void fold(TexelSums& sums, Image& image, DirtyBlocks& dirty) {
    const std::uint32_t channels = sums.channels;
    constexpr std::size_t kTexels = std::size_t{kTexelBlock} * kTexelBlock;
    const std::size_t block_floats = kTexels * channels;
    parallel_for(sums.bands.front().dirty.size(), [&](std::size_t block) {
        bool any = false;
        for (const TexelBand& band : sums.bands) any |= band.dirty[block] != 0;
        if (!any) return;
        const auto x0 = static_cast<std::uint32_t>(block % sums.blocks_x) * kTexelBlock;
        const auto y0 = static_cast<std::uint32_t>(block / sums.blocks_x) * kTexelBlock;
        const std::size_t wide = std::min(kTexelBlock, sums.width - x0);
        const std::uint32_t high = std::min(kTexelBlock, sums.height - y0);

        std::array<float, 3 * kTexels> total;
        std::fill_n(total.begin(), block_floats, 0.0f);
        for (TexelBand& band : sums.bands) {
            if (!band.dirty[block]) continue;
            float* from = band.values.get() + block * block_floats;
            for (std::size_t i = 0; i < block_floats; ++i) total[i] += from[i];
            std::fill_n(from, block_floats, 0.0f);
            band.dirty[block] = 0;
        }
        for (std::uint32_t y = 0; y < high; ++y) {
            const float* row = &total[std::size_t{y} * kTexelBlock * channels];
            const std::size_t at = image.index(static_cast<int>(x0), static_cast<int>(y0 + y));
            float* to = &image.values[at];
            mark_dirty(dirty, at, at + wide * static_cast<std::size_t>(image.channels));
            if (!sums.of_luminance)
                std::copy_n(row, wide * channels, to);
            else
                for (std::size_t i = 0; i < wide; ++i)
                    for (std::size_t c = 0; c < 3; ++c)
                        to[3 * i + c] = kLuminanceWeights[c] * row[i];
        }
    });
}

}  // namespace burnish
