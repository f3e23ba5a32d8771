#include "burnish/inverse/theta.h"

#include <algorithm>

namespace burnish {

TextureTable texture_table(const Scene& scene, const Theta& theta) {
    TextureTable table;
    table.textures = scene.textures;
    table.values.assign(scene.textures.size(), nullptr);
    for (const ThetaTexture& t : theta.textures)
        table.values[static_cast<std::size_t>(t.texture.value)] = t.values.values.data();
    return table;
}

std::vector<int> theta_slots(const Scene& scene, const Theta& theta) {
    std::vector<int> slots(scene.textures.size(), -1);
    for (std::size_t i = 0; i < theta.textures.size(); ++i)
        slots[static_cast<std::size_t>(theta.textures[i].texture.value)] = static_cast<int>(i);
    return slots;
}

bool read_as_color(const Scene& scene, TextureId texture) {
    const auto color = [](const Bsdf& bsdf) {
        const auto* diffuse = std::get_if<Diffuse>(&bsdf);
        return diffuse ? diffuse->reflectance : std::get<Principled>(bsdf).base_color;
    };
    return std::any_of(scene.bsdfs.begin(), scene.bsdfs.end(),
                       [&](const Bsdf& bsdf) { return color(bsdf).texture == texture; });
}

std::vector<char> dynamic_bsdfs(const Scene& scene, const Theta& theta) {
    const std::vector<int> slots = theta_slots(scene, theta);
    const auto optimised = [&](TextureId id) {
        return id && slots[static_cast<std::size_t>(id.value)] >= 0;
    };
    std::vector<char> dynamic(scene.bsdfs.size(), 0);
    for (std::size_t i = 0; i < scene.bsdfs.size(); ++i) {
        if (const auto* diffuse = std::get_if<Diffuse>(&scene.bsdfs[i])) {
            dynamic[i] = optimised(diffuse->reflectance.texture);
        } else {
            const auto& principled = std::get<Principled>(scene.bsdfs[i]);
            dynamic[i] = optimised(principled.base_color.texture);
            for (const ScalarInput& input : principled.scalars)
                dynamic[i] |= optimised(input.texture);
        }
    }
    return dynamic;
}

}  // namespace burnish
