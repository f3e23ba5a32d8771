#include "scene/material.h"

namespace burnish {

std::vector<TextureId> textures_of(const Bsdf& bsdf) {
    std::vector<TextureId> textures;
    const auto add = [&](TextureId id) {
        if (id) textures.push_back(id);
    };
    if (const auto* diffuse = std::get_if<Diffuse>(&bsdf)) {
        add(diffuse->reflectance.texture);
    } else {
        const auto& principled = std::get<Principled>(bsdf);
        add(principled.base_color.texture);
        for (const ScalarInput& input : principled.scalars) add(input.texture);
    }
    return textures;
}

}  // namespace burnish
