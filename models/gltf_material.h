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
    /// Those of which json has the indices. Empty: it has those of the document.
    std::vector<GltfTexture> textures;
    /// What the coordinates of a mesh turn into, for TEXCOORD_0, TEXCOORD_1, ...; the first are its
    /// own, which give it its tangents.
    std::vector<UvTransform> uv_sets;
};

/// With pictures of what the material reads.
GltfSurface make_surface(const Scene& scene, const TextureTable& textures, MaterialId material);

/// Moves the textures of a surface into the document.
void add_textures(GltfModel& model, GltfSurface& surface);

/// Adds the material of a shape whose surface has its textures there: its index in the document.
int add_material(GltfModel& model, const Scene& scene, const GltfSurface& surface,
                 const Shape& shape);

}  // namespace burnish
