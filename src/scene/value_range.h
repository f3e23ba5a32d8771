// What numbers and texels of a scene may be.
#pragma once

#include "scene/scene.h"

namespace burnish {

/// The most that texels of a texture may be where BSDFs read it: 2 where all of them do so as the
/// `diff_trans` of `principledthin`, else 1. Unknowns stay within [0, 1] all the same.
float largest_value(const Scene& scene, TextureId texture);

}  // namespace burnish
