// A floor of strips, one for every kind of unknown, under three kinds of light, with surfaces and a
// sky that have none: pixels mix all of them.
#pragma once

#include "gradient/small_scene.h"

namespace burnish::test {

/// Strips from left to right: base colour and roughness; metallic alone; anisotropic and spec tint;
/// the reflectance of a diffuse surface; nothing.
inline Scene make_strip_scene(int side, int texels) {
    Scene scene = make_small_scene();
    scene.film = {side, side, 0, 0, side, side, scene.film.filter};
    Bitmap base = make_bitmap(texels, 3, TextureFilter::kBilinear, 0.35f, 0.65f, 201);
    const auto scalar = [&](std::uint32_t seed) {
        return make_bitmap(2 * texels, 1, TextureFilter::kNearest, 0.35f, 0.65f, seed);
    };
    scene.textures = {
        base,        scalar(202),
        scalar(203), scalar(204),
        scalar(205), make_bitmap(texels, 3, TextureFilter::kBilinear, 0.35f, 0.65f, 206)};
    using P = PrincipledScalar;
    Principled colored, metallic, brushed;
    colored.base_color.texture = {0};
    colored[P::kRoughness].texture = {1};
    colored[P::kMetallic].constant = 0.6f;
    metallic.base_color.constant = {0.7f, 0.4f, 0.2f};
    metallic[P::kRoughness].constant = 0.4f;
    metallic[P::kMetallic].texture = {2};
    brushed.base_color.constant = {0.3f, 0.5f, 0.7f};
    brushed[P::kRoughness].constant = 0.7f;
    brushed[P::kMetallic].constant = 0.7f;
    brushed[P::kAnisotropic].texture = {3};
    brushed[P::kSpecTint].texture = {4};
    brushed.has_anisotropic = brushed.has_spec_tint = true;
    Diffuse diffuse, constant, black;
    diffuse.reflectance.texture = {5};
    constant.reflectance.constant = {0.5f, 0.4f, 0.3f};
    black.reflectance.constant = {0, 0, 0};
    scene.bsdfs = {colored, metallic, brushed, diffuse, constant, black};
    scene.materials.clear();
    for (std::int32_t i = 0; i < 5; ++i)
        scene.materials.push_back({"strip " + std::to_string(i), {i}, {i}});
    scene.materials.push_back({"light", {5}, {}});
    const std::vector<Shape> lights(scene.shapes.begin() + 1, scene.shapes.end());
    scene.shapes.clear();
    for (std::int32_t i = 0; i < 5; ++i)
        scene.shapes.push_back(
            {"strip",
             make_quad({-1 + 0.4f * static_cast<float>(i), -1, 0}, {0.4f, 0, 0}, {0, 2, 0}),
             {i},
             {}});
    for (Shape light : lights) {
        light.material = {5};
        scene.shapes.push_back(light);
    }
    scene.emitters = {AreaEmitter{{3, 2.5f, 2}, {5}}, AreaEmitter{{2, 3, 4}, {6}},
                      ConstantEmitter{{1.0f, 1.0f, 1.1f}}};
    scene.parameters = {{"base_color", {0}},  {"roughness", {1}}, {"metallic", {2}},
                        {"anisotropic", {3}}, {"spec_tint", {4}}, {"reflectance", {5}}};
    return scene;
}

}  // namespace burnish::test
