// Which texels a picture can say anything about.
#pragma once

#include <vector>

#include "burnish/inverse/gradient.h"
#include "burnish/render/render.h"

namespace burnish {

/// For each texture of theta and each of its texels, [height, width]: non-zero where light paths
/// meet it on the way to the camera, found by `passes` samples per pixel of the derivative of the
/// image's sum.
std::vector<std::vector<char>> reached_texels(const TracedScene& scene, const Theta& theta,
                                              std::uint32_t seed, std::uint32_t passes,
                                              const Progress& progress = {});

/// Root mean squared difference over the reached texels and their channels; NaN where none is
/// reached. reached: [height, width].
double texture_error(const Image& texels, const Image& truth, const std::vector<char>& reached);

}  // namespace burnish
