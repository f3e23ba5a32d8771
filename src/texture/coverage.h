// Which texels a picture can say anything about.
#pragma once

#include <cstdint>
#include <vector>

#include "gradient/theta.h"
#include "paths/trace.h"
#include "render/render.h"

namespace burnish {

/// For each texture of theta and each of its texels, [height, width]: non-zero where light paths
/// meet it on the way to the camera, found by `passes` samples per pixel of the derivative of the
/// image's sum.
std::vector<std::vector<char>> visited_texels(const TracedScene& scene, const Theta& theta,
                                              std::uint32_t seed, std::uint32_t passes,
                                              const Progress& progress = {});

/// Root mean squared difference over the visited texels and their channels; NaN where none is
/// visited. visited: [height, width].
double texture_error(const Image& texels, const Image& truth, const std::vector<char>& visited);

/// Gives texels that no sample visited the mean of those around them that samples did visit, from
/// as near as there are any (push and pull over halved resolutions). visits: [height, width],
/// non-zero where samples came. Nothing changes where no texel or every texel was visited.
void fill_unvisited(const std::vector<std::uint32_t>& visits, Image& texels);

/// Gives texels that no sample visited the value that they have in `initial`.
void keep_unvisited(const std::vector<std::uint32_t>& visits, const Image& initial, Image& texels);

}  // namespace burnish
