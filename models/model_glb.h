// A scene as binary glTF 2.0: its shapes in world space, their materials with the recovered
// textures, its cameras. Axes and units are the scene's, though glTF's y points up and its unit is
// a metre. The sky is left out: glTF has none.
#pragma once

#include <string>

#include "scene/scene.h"
#include "shading/texture.h"

namespace burnish {

/// textures: what the materials read.
std::string model_glb(const Scene& scene, const TextureTable& textures);

}  // namespace burnish
