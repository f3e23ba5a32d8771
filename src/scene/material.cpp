#include "scene/material.h"

#include "core/variant.h"

namespace burnish {

const ColorInput& color_of(const Bsdf& bsdf) {
    return match(
        bsdf, [](const Diffuse& b) -> const ColorInput& { return b.reflectance; },
        [](const Principled& b) -> const ColorInput& { return b.base_color; });
}

std::span<const ScalarInput> scalars_of(const Bsdf& bsdf) {
    using Scalars = std::span<const ScalarInput>;
    return match(
        bsdf, [](const Diffuse&) { return Scalars(); },
        [](const Principled& b) { return Scalars(b.scalars); });
}

bool transmits(const Bsdf& bsdf) {
    return match(
        bsdf, [](const Diffuse&) { return false; },
        [](const Principled& b) { return b.has_spec_trans; });
}

bool mixes_channels(const Bsdf& bsdf) {
    return match(
        bsdf, [](const Diffuse&) { return false; },
        [](const Principled& b) { return b.has_spec_tint || b.has_sheen; });
}

std::vector<TextureId> textures_of(const Bsdf& bsdf) {
    std::vector<TextureId> textures;
    const auto add = [&](TextureId id) {
        if (id) textures.push_back(id);
    };
    add(color_of(bsdf).texture);
    for (const ScalarInput& input : scalars_of(bsdf)) add(input.texture);
    return textures;
}

}  // namespace burnish
