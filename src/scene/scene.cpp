#include "scene/scene.h"

#include <algorithm>

namespace burnish {

std::vector<TextureId> textures_of(const Scene& scene, MaterialId material) {
    std::vector<TextureId> textures;
    if (!material) return textures;
    const Material& m = scene[material];
    for (const BsdfId id : {m.front, m.back})
        if (id)
            for (const TextureId t : textures_of(scene[id]))
                if (std::find(textures.begin(), textures.end(), t) == textures.end())
                    textures.push_back(t);
    return textures;
}

}  // namespace burnish
