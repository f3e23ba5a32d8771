// Texels that no sample visited: how many, and what they become.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "image/image.h"
#include "texture/charts.h"

namespace burnish {

/// Gives texels that no sample visited the mean of those around them that samples did visit, from
/// as near as there are any (push and pull over halved resolutions): of their own chart, as long as
/// it has any. Those of no chart take the values at the border of the nearest one, which filters
/// and smaller copies of the texture read. visits: [height, width], non-zero where samples came.
/// charts: [height, width]; empty: one. repeats: texels at opposite borders of the texture are
/// neighbours; at the end of an odd side only for those of no chart, as the levels' texels do not
/// pair up there. Nothing changes where no texel or every texel was visited.
void fill_unvisited(const std::vector<std::uint32_t>& visits, const ChartMap& charts, bool repeats,
                    Image& texels);

/// How many texels a surface reads that no sample visited. charts: [height, width].
std::size_t count_unvisited(const std::vector<std::uint32_t>& visits, const ChartMap& charts);

/// Gives texels that no sample visited their values of `initial`, [height, width, channels].
void keep_unvisited(const std::vector<std::uint32_t>& visits, std::span<const float> initial,
                    Image& texels);

}  // namespace burnish
