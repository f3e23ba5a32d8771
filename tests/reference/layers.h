// The small scene whose floor blends materials, or has a normal map.
#pragma once

#include "gradient/small_scene.h"
#include "scene/blends.h"

namespace burnish::test {

/// Texture 2: shares; texture 3: a normal map, some of whose normals face away from the camera.
inline Scene scene_with_layer_textures() {
    Scene scene = make_small_scene();
    scene.textures.push_back(make_bitmap(4, 1, TextureFilter::kBilinear, 0.1f, 0.9f, 63));
    Bitmap normals = make_bitmap(8, 3, TextureFilter::kBilinear, 0.05f, 0.95f, 64);
    for (std::size_t i = 2; i < normals.values.size(); i += 3)
        normals.values[i] = 0.6f + 0.4f * normals.values[i];
    scene.textures.push_back(normals);
    return scene;
}

/// The floor beside another material, by the shares.
inline Scene blended_floor(const Bsdf& other, bool two_sided) {
    Scene scene = scene_with_layer_textures();
    scene.bsdfs.push_back(other);
    const BsdfId id{static_cast<std::int32_t>(scene.bsdfs.size()) - 1};
    const Material floor = scene.materials[0];
    scene.materials.push_back({"other", id, two_sided ? id : BsdfId{}});
    scene.materials.push_back(floor);
    const auto last = static_cast<std::int32_t>(scene.materials.size()) - 1;
    scene.materials[0].blend = MaterialBlend{{0, {2}}, {last - 1}, {last}};
    return scene;
}

inline Scene turned_floor(bool flip_invalid = true, bool shadowing = true) {
    Scene scene = scene_with_layer_textures();
    scene.materials[0].normals = NormalMap{{3}, flip_invalid, shadowing};
    return scene;
}

/// Texture 2 as heights.
inline Scene bumpy_floor() {
    Scene scene = scene_with_layer_textures();
    scene.materials[0].normals = NormalMap{{2}, true, true, 0.3f};
    return scene;
}

/// The bumpy floor seen from behind, one-sided inside of two sides.
inline Scene mirrored_floor() {
    Scene scene = bumpy_floor();
    scene.materials[0].normals->mirrored = true;
    auto& triangles = std::get<Mesh>(scene.shapes[0].geometry).triangles;
    for (Triangle& t : triangles) std::swap(t.vertex[0], t.vertex[1]);
    return scene;
}

/// Another BSDF on the back of the floor, which turned normals may show.
inline Scene turned_floor_of_two_sides() {
    Scene scene = turned_floor(false);
    scene.bsdfs.push_back(Diffuse{{{0.3f, 0.5f, 0.7f}, {}}});
    scene.materials[0].back = {2};
    return scene;
}

/// A normal map around a blend.
inline Scene turned_blend() {
    Scene scene = blended_floor(Diffuse{{{0.3f, 0.5f, 0.7f}, {}}}, true);
    for (std::size_t m = 2; m < scene.materials.size(); ++m)
        scene.materials[m].normals = NormalMap{{3}};
    return scene;
}

struct NamedScene {
    const char* name;
    Scene scene;
};

/// The weights of the floor's blends as unknowns: textures 2 and, where a blend is inside of it, 3.
inline Scene with_unknown_weights(Scene scene, bool inner = false) {
    scene.parameters.push_back({"floor.weight.data", {2}});
    if (inner) scene.parameters.push_back({"floor.inner.weight.data", {3}});
    separate_parts(scene);
    return scene;
}

/// A blend in the place of the first material of the floor's blend: the floor's BSDF once more, and
/// a mirror.
inline Scene nested_floor(TextureId inner_weight) {
    Scene scene = blended_floor(Conductor{kWhite, {{0.2f, 0.9f, 1.1f}, {3.9f, 2.4f, 2.2f}}}, true);
    const auto count = static_cast<std::int32_t>(scene.materials.size());
    scene.materials.push_back(scene.materials[2]);
    scene.materials.push_back({"again", {0}, {0}});
    scene.materials[2].blend = MaterialBlend{{0, inner_weight}, {count}, {count + 1}};
    return scene;
}

inline std::vector<NamedScene> floors_of_unknown_weights() {
    const Diffuse pale{{{0.3f, 0.5f, 0.7f}, {}}};
    Scene turned = turned_blend();
    return {
        {"weight", with_unknown_weights(blended_floor(pale, true))},
        {"weight of two with unknowns",
         with_unknown_weights(blended_floor(Diffuse{{{}, {0}}}, true))},
        {"opacity",
         with_unknown_weights(blended_floor(Dielectric{{kWhite, kWhite}, 1, true}, false))},
        {"weight of smooth plastic", with_unknown_weights(blended_floor(
                                         Plastic{{pale.reflectance, kWhite}, 1.5f, true}, true))},
        {"weights inside of weights", with_unknown_weights(nested_floor({3}), true)},
        {"one weight twice", with_unknown_weights(nested_floor({2}))},
        {"weight below a normal map", with_unknown_weights(turned)},
    };
}

}  // namespace burnish::test
