// Which texels of the next coarser level a texel reads, on one axis, and which ones read it: what
// prolongation and restriction share.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "image/image.h"

namespace burnish {

/// Bilinear: a texel reads two coarse ones on an axis, with 3/4 and 1/4.
struct Prolongation {
    bool repeats = false;  ///< the texture does: texels at opposite borders are neighbours
};

/// Texels of a level that do not read the next coarser one by the usual weights, because some
/// of the four texels there belong to another chart: these weigh nothing, and the others add up to
/// one, if there are any.
struct ChartBorders {
    struct Texel {
        int x = 0;
        std::array<float, 4> weight{};  ///< of (near, near), (far, near), (near, far), (far, far)
    };
    std::vector<Texel> texels;      ///< by row, then by column
    std::vector<std::size_t> rows;  ///< where each row begins, [height + 1]; empty: no such texels
};

/// The two coarse texels that a fine one reads on an axis.
struct Taps {
    int near = 0, far = 0;
};

inline Taps taps_of(int fine, int coarse_size, bool repeats) {
    const int near = fine / 2, far = fine % 2 == 0 ? near - 1 : near + 1;
    if (far < 0) return {near, repeats ? coarse_size - 1 : 0};
    if (far == coarse_size) return {near, repeats ? 0 : coarse_size - 1};
    return {near, far};
}

/// Bilinear: texel centres lie at (i + 1/2) / size.
inline constexpr float kNear = 0.75f, kFar = 0.25f;

inline float weight_of(const Taps& taps, int coarse) {
    return (taps.near == coarse ? kNear : 0.0f) + (taps.far == coarse ? kFar : 0.0f);
}

/// Calls body(fine) for each texel of an axis, once, that may read a coarse one.
template <class Body>
void for_readers(const Prolongation& prolongation, int coarse, int fine_size, const Body& body) {
    const int begin = 2 * coarse - 1, end = 2 * coarse + 3;
    if (prolongation.repeats && fine_size > end - begin)
        for (int i = begin; i < end; ++i) body((i + fine_size) % fine_size);
    else if (prolongation.repeats)
        for (int i = 0; i < fine_size; ++i) body(i);
    else
        for (int i = std::max(0, begin); i < std::min(fine_size, end); ++i) body(i);
}

inline const float* row_of(const Image& image, int y) { return &image.values[image.index(0, y)]; }

inline std::span<const ChartBorders::Texel> row_of(const ChartBorders& borders, int y) {
    if (borders.rows.empty()) return {};
    const auto row = static_cast<std::size_t>(y);
    return std::span(borders.texels)
        .subspan(borders.rows[row], borders.rows[row + 1] - borders.rows[row]);
}

/// The coarse columns [first, last).
struct Columns {
    int first = 0, last = 0;
};

/// The coarse columns that fine ones [x0, x1) may read, but for those at the other end of a level
/// that repeats.
inline Columns columns_of(int x0, int x1, int coarse_width) {
    return {std::max(0, x0 / 2 - 1), std::min(coarse_width, (x1 + 1) / 2 + 1)};
}

}  // namespace burnish
