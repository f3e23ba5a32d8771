// What numbers and texels of a scene may be.
#pragma once

#include "scene/scene.h"

namespace burnish {

/// The most that `diff_trans` of a `principledthin` may be.
inline constexpr float kMaxDiffTrans = 2;

/// The most that texels of a texture may be where BSDFs read it: kMaxDiffTrans where all of them do
/// so as `diff_trans`, else 1. Unknowns stay within [0, 1] all the same.
float largest_value(const Scene& scene, TextureId texture);

}  // namespace burnish
