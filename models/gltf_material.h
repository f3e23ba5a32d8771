// Mitsuba's BSDFs as glTF's metallic-roughness material with its extensions. What gets lost on the
// way is in docs/reference/file-formats.md.
#pragma once

#include <vector>

#include "models/gltf_model.h"
#include "scene/scene.h"
#include "shading/texture.h"

namespace burnish {

/// A material without the light of a shape.
struct GltfSurface {
    nlohmann::json json;
    /// What the coordinates of a mesh turn into, for TEXCOORD_0, TEXCOORD_1, ...
    std::vector<UvTransform> uv_sets;
};

/// Adds the textures that a material reads.
GltfSurface make_surface(GltfModel& model, const Scene& scene, const TextureTable& textures,
                         MaterialId material);

/// Adds the material of a shape whose surface is known: its index in the document.
int add_material(GltfModel& model, const Scene& scene, const GltfSurface& surface,
                 const Shape& shape);

}  // namespace burnish
