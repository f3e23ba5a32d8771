// Which texels of a texture lie side by side on a surface: neighbours in the texture may be far
// apart in the world.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace burnish {

/// The chart of each texel, [height, width]: 0 where no surface reads it, otherwise a number from 1
/// on.
using ChartMap = std::vector<std::uint32_t>;

/// The charts of a bitmap: sets of triangles that share vertices (position and texture coordinate)
/// and so are continuous in the texture. A texel belongs to the chart that covers its centre, or
/// else to one whose look-ups reach it; charts that overlap in the texture, or whose borders meet
/// in the centre of a texel, are one. Everything is one chart where a shape without texture
/// coordinates, a sphere or a disk reads the bitmap, and where it is repeated so often that there
/// is little to tell apart.
ChartMap texture_charts(const Scene& scene, TextureId texture);

}  // namespace burnish
