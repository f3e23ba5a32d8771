#include "scene/blends.h"

#include <algorithm>
#include <set>

namespace burnish {

namespace {

struct Separation {
    Scene& scene;
    std::vector<char> taken;      ///< by another material, or with other shares; parallel to bsdfs
    std::set<std::int32_t> done;  ///< materials

    /// The BSDF of a material, or a copy of it.
    BsdfId own(BsdfId id, const std::vector<BlendShare>& shares) {
        const auto i = static_cast<std::size_t>(id.value);
        if (!taken[i]) {
            taken[i] = 1;
            scene.shares[i] = shares;
            return id;
        }
        if (scene.shares[i] == shares) return id;
        const Bsdf copy = scene.bsdfs[i];
        scene.bsdfs.push_back(copy);
        scene.shares.push_back(shares);
        taken.push_back(1);
        return {static_cast<std::int32_t>(scene.bsdfs.size()) - 1};
    }

    void visit(MaterialId id, const std::vector<BlendShare>& shares) {
        if (!done.insert(id.value).second) return;
        Material& m = scene.materials[static_cast<std::size_t>(id.value)];
        if (!m.blend) {
            const BsdfId front = m.front;
            m.front = own(front, shares);
            if (m.back) m.back = m.back == front ? m.front : own(m.back, shares);
            return;
        }
        const TextureId weight = m.blend->weight.texture;
        const Bitmap* bitmap = weight ? bitmap_of(scene[weight]) : nullptr;
        const bool free = bitmap && !bitmap->is_attribute;
        for (const bool second : {false, true}) {
            std::vector<BlendShare> inner = shares;
            if (free) inner.push_back({weight, second});
            visit(second ? m.blend->second : m.blend->first, inner);
        }
        m.front = scene[m.blend->second].front, m.back = scene[m.blend->second].back;
    }
};

}  // namespace

void separate_parts(Scene& scene) {
    if (std::none_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return m.blend.has_value(); }))
        return;
    scene.shares.assign(scene.bsdfs.size(), {});
    Separation s{scene, std::vector<char>(scene.bsdfs.size(), 0), {}};
    // What is in no blend keeps its BSDF.
    for (const bool blends : {false, true})
        for (const auto* shapes : {&scene.shapes, &scene.prototypes})
            for (const Shape& shape : *shapes)
                if (shape.material && scene[shape.material].blend.has_value() == blends)
                    s.visit(shape.material, {});
}

}  // namespace burnish
