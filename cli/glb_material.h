// What a material of binary glTF says of the meshes that have it.
#pragma once

#include "cli/glb_file.h"
#include "scene/texture.h"

namespace burnish {

struct GlbMaterial {
    bool is_double_sided = false;
    // Of its first texture: base colour, metallic and roughness, normals, occlusion, emission.
    std::size_t uv_set = 0;  ///< n of TEXCOORD_n
    UvTransform to_uv = {};  ///< KHR_texture_transform: from that set to where it is read
};

/// Of a material that the document does not have: the defaults. Throws InputError as accessor does.
GlbMaterial read_material(const Glb& glb, std::size_t index);

}  // namespace burnish
