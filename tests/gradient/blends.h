// Scenes whose blends have unknown weights: direct light on a floor, and a room in which light
// bounces.
#pragma once

#include "gradient/room.h"
#include "scene/blends.h"

namespace burnish::test {

inline MaterialId add_material(Scene& scene, BsdfId bsdf, bool two_sided = true) {
    scene.materials.push_back({"part", bsdf, two_sided ? bsdf : BsdfId{}});
    return {static_cast<std::int32_t>(scene.materials.size()) - 1};
}

inline BsdfId add_bsdf(Scene& scene, const Bsdf& bsdf) {
    scene.bsdfs.push_back(bsdf);
    return {static_cast<std::int32_t>(scene.bsdfs.size()) - 1};
}

inline TextureId add_weight(Scene& scene, const char* name, int size, std::uint32_t seed) {
    scene.textures.emplace_back(make_bitmap(size, 1, TextureFilter::kNearest, 0.3f, 0.7f, seed));
    const TextureId id{static_cast<std::int32_t>(scene.textures.size()) - 1};
    scene.parameters.push_back({name, id});
    return id;
}

/// The small scene; its floor is a mask around a blend of what it was and a mirror. Texture 2: the
/// weight of the mirror. Texture 3: the opacity.
inline Scene make_small_scene_of_blends(const SmallSceneOptions& options = {}) {
    Scene scene = make_small_scene(options);
    const MetalIndex gold{{0.2f, 0.9f, 1.1f}, {3.9f, 2.4f, 2.2f}};
    const MaterialId floor = add_material(scene, {0}),
                     mirror = add_material(
                         scene,
                         add_bsdf(scene, Conductor{ColorInput{{0.3f, 0.3f, 0.3f}, {}}, gold})),
                     blend = add_material(scene, {0}),
                     nothing = add_material(
                         scene, add_bsdf(scene, Dielectric{{kWhite, kWhite}, 1, true}), false);
    const auto at = [&](MaterialId id) -> Material& {
        return scene.materials[static_cast<std::size_t>(id.value)];
    };
    at(blend).blend =
        MaterialBlend{{0, add_weight(scene, "floor.weight.data", 2, 67)}, floor, mirror};
    at({0}).blend =
        MaterialBlend{{0, add_weight(scene, "floor.opacity.data", 2, 68)}, nothing, blend};
    separate_parts(scene);
    return scene;
}

/// The room, open to a pale sky through a mask in its left wall, with a floor that is in part
/// painted as the other walls are. Texture 3: the weight of the paint. Texture 4: the opacity of
/// the wall.
inline Scene make_room_of_blends() {
    Scene scene = make_room();
    scene.emitters.push_back(ConstantEmitter{{0.6f, 0.8f, 1.0f}});
    std::get<Diffuse>(scene.bsdfs[2]).reflectance.constant = {0.2f, 0.15f, 0.1f};
    const MaterialId floor = add_material(scene, {0}), paint = add_material(scene, {2}),
                     nothing = add_material(
                         scene, add_bsdf(scene, Dielectric{{kWhite, kWhite}, 1, true}), false),
                     wall = add_material(scene, {1});
    scene.materials[0].blend =
        MaterialBlend{{0, add_weight(scene, "floor.weight.data", 2, 67)}, floor, paint};
    scene.materials[1].blend =
        MaterialBlend{{0, add_weight(scene, "wall.opacity.data", 2, 68)}, nothing, wall};
    separate_parts(scene);
    return scene;
}

}  // namespace burnish::test
