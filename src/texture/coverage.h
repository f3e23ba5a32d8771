// Which texels a picture can say anything about.
#pragma once

#include <cstdint>
#include <vector>

#include "gradient/reservoirs/reservoirs.h"
#include "render/render.h"

namespace burnish {

/// For each texture of theta and each of its texels, [height, width]: non-zero where light paths
/// meet it on the way to the camera, found by `passes` samples per pixel of the derivative of the
/// image's sum.
std::vector<std::vector<char>> visited_texels(const TracedScene& scene, const Theta& theta,
                                              std::uint32_t seed, std::uint32_t passes,
                                              const Progress& progress = {});

/// Root mean squared difference over the reached texels and their channels; NaN where none is
/// reached. reached: [height, width].
double texture_error(const Image& texels, const Image& truth, const std::vector<char>& reached);

/// What becomes of texels that no sample of a descent reached.
enum class Unvisited {
    kFill,  ///< the mean of their surroundings
    kKeep   ///< they stay as they were at the start
};

/// Gives texels that no sample reached the mean of those around them that samples did reach, from
/// as near as there are any (push and pull over halved resolutions). informed: [height, width],
/// non-zero where samples reached. Nothing changes where no texel or every texel is informed.
void fill_unvisited(const std::vector<std::uint32_t>& visits, Image& texels);

/// Gives texels that no sample reached the value that they have in `initial`.
void keep_unvisited(const std::vector<std::uint32_t>& visits, const Image& initial,
                     Image& texels);

}  // namespace burnish
