// What pictures can resolve of a texture, at best: the texture as their pixels see it.
#pragma once

#include <vector>

#include "burnish/renderer.h"
#include "scene/scene.h"

namespace burnish {

/// The texture, each pixel of which is the mean over the pixels that see it of the means that they
/// see, in the view that sees its surroundings largest; weighted with the reconstruction filter.
/// Texels that no view sees stay as they are. [height, width, channels] as `texels`.
Image over_footprints(const std::vector<Renderer>& views, TextureId texture, const Image& texels);

}  // namespace burnish
