// A room lit by one panel, 16 x 16 pixels: most of what the camera sees is light that has bounced.
// The floor and a wall have unknowns, so that paths meet several of them.
#pragma once

#include "gradient/small_scene.h"
#include "paths/trace_input.h"

namespace burnish::test {

/// Texture 0: base colour of the floor, 4 x 4, bilinear. Texture 1: its roughness, 8 x 8, nearest.
/// Texture 2: reflectance of the left wall, 4 x 4, nearest. A box filter: a pixel's samples are its
/// own.
inline Scene make_room() {
    Scene scene;
    scene.camera.to_world = look_at({0.1, -0.93, 1.1}, {-0.1, 1, 0.7}, {0, 0, 1});
    scene.camera.fov_x = 75;
    scene.film = {16, 16, 0, 0, 16, 16, {FilterKind::kBox, 0.5f}};
    scene.max_depth = 5;
    scene.rr_depth = 2;
    scene.textures = {make_bitmap(4, 3, TextureFilter::kBilinear, 0.4f, 0.9f, 64),
                      make_bitmap(8, 1, TextureFilter::kNearest, 0.35f, 0.7f, 65),
                      make_bitmap(4, 3, TextureFilter::kNearest, 0.4f, 0.9f, 66)};
    Principled floor;
    floor.base_color.texture = {0};
    floor[PrincipledScalar::kRoughness].texture = {1};
    floor[PrincipledScalar::kMetallic].constant = 0.4f;
    Diffuse wall, paint, black;
    wall.reflectance.texture = {2};
    paint.reflectance.constant = {0.8f, 0.6f, 0.4f};
    black.reflectance.constant = {0, 0, 0};
    scene.bsdfs = {floor, wall, paint, black};
    scene.materials = {
        {"floor", {0}, {0}}, {"wall", {1}, {1}}, {"paint", {2}, {2}}, {"light", {3}, {}}};
    scene.emitters = {AreaEmitter{{14, 12, 10}, {6}}};
    scene.shapes = {
        {"floor", make_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), {0}, {}},
        {"left", make_quad({-1, -1, 0}, {0, 2, 0}, {0, 0, 2}), {1}, {}},
        {"right", make_quad({1, -1, 0}, {0, 2, 0}, {0, 0, 2}), {2}, {}},
        {"back", make_quad({-1, 1, 0}, {2, 0, 0}, {0, 0, 2}), {2}, {}},
        {"front", make_quad({-1, -1, 0}, {2, 0, 0}, {0, 0, 2}), {2}, {}},
        {"ceiling", make_quad({-1, -1, 2}, {2, 0, 0}, {0, 2, 0}), {2}, {}},
        {"panel", make_quad({-0.3f, 0.1f, 1.9f}, {0, 0.5f, 0}, {0.5f, 0, 0}), {3}, {0}}};
    scene.parameters = {{"floor.base_color.data", {0}},
                        {"floor.roughness.data", {1}},
                        {"wall.reflectance.data", {2}}};
    return scene;
}

/// A camera sample of each pixel.
inline std::vector<BatchSample> one_of_each_pixel(const Scene& scene, std::uint32_t pass) {
    std::vector<BatchSample> samples;
    const auto pixels = static_cast<std::uint32_t>(scene.film.crop_width * scene.film.crop_height);
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) samples.push_back({{pixel, pass, 0}});
    return samples;
}

}  // namespace burnish::test
