// The small scene whose floor blends materials, or has a normal map.
#pragma once

#include "gradient/small_scene.h"

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

}  // namespace burnish::test
