// Which parts of blends their weights count for, where these may be unknowns.
#pragma once

#include "scene/scene.h"

namespace burnish {

/// Fills Scene::shares for the weights that are bitmaps. A BSDF that shapes show in several ways,
/// in two blends or in one and by itself, becomes one for each way: records name the BSDF, and with
/// it what multiplies its value. Once more changes nothing.
void separate_parts(Scene& scene);

}  // namespace burnish
