// Smoothing over the grid of a texture that stops at the borders of charts: the preconditioner of
// large steps [Nicolet et al. 2021], one direction at a time.
#pragma once

#include <cstdint>
#include <vector>

#include "image/image.h"
#include "texture/charts.h"

namespace burnish {

/// Which neighbours on the grid are neighbours on a surface, [height, width]: 1 where a texel and
/// the next one in its row (`right`) or its column (`down`) belong to one chart.
struct TexelLinks {
    int width = 0, height = 0;
    std::vector<std::uint8_t> right, down;
};

/// charts: [height, width]; empty: one chart. Texels of no chart have no neighbours, nor have those
/// at opposite borders.
TexelLinks link_texels(int width, int height, const ChartMap& charts);

/// values <- (I + lambda D)^-1 values in every row, D the Laplacian of the row's linked texels: a
/// mean over some sqrt(lambda) texels that keeps constants. Symmetric, solved exactly in O(texels)
/// [Thomas 1949]. lambda >= 0.
void smooth_rows(const TexelLinks& links, float lambda, Image& values);

/// The same in every column.
void smooth_columns(const TexelLinks& links, float lambda, Image& values);

}  // namespace burnish
