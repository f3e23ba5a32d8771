// Mitsuba's BSDFs as glTF's metallic-roughness material with its extensions. What gets lost on the
// way is in docs/reference/file-formats.md.
#pragma once

#include <vector>

#include "cli/gltf_model.h"
#include "scene/scene.h"
#include "shading/texture.h"

namespace burnish {

struct GltfMaterial {
    int index = 0;  ///< in the document
    /// What the coordinates of a mesh turn into, for TEXCOORD_0, TEXCOORD_1, ...
    std::vector<UvTransform> uv_sets;
};

/// Adds the material of a shape, its light included, with the textures that it reads.
GltfMaterial add_material(GltfModel& model, const Scene& scene, const TextureTable& textures,
                          const Shape& shape);

}  // namespace burnish
