// A small scene built from scratch: a textured floor under three kinds of light, 16 x 16 pixels.
// Some texels of its textures are hit in every iteration, some less than once.
#pragma once

#include "gradient/theta.h"
#include "random_source.h"

namespace burnish::test {

struct SmallSceneOptions {
    bool gray = false;  ///< base colour equal in all channels
    FilterKind filter = FilterKind::kGaussian;
    float filter_radius = 2;
};

/// A parallelogram with uv (0, 0), (1, 0), (1, 1), (0, 1) at its corners.
inline Mesh make_quad(const Vec3f& corner, const Vec3f& u, const Vec3f& v) {
    Mesh mesh;
    mesh.positions = {corner, corner + u, corner + u + v, corner + v};
    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
    return mesh;
}

inline Bitmap make_bitmap(int size, int channels, TextureFilter filter, float low, float high,
                          std::uint32_t seed) {
    Bitmap bitmap;
    bitmap.width = bitmap.height = size;
    bitmap.channels = channels;
    bitmap.filter = filter;
    RandomSource random{seed};
    bitmap.values.resize(static_cast<std::size_t>(size * size * channels));
    for (float& v : bitmap.values) v = random.next(low, high);
    return bitmap;
}

/// Texture 0: base colour, 4 x 4, bilinear, mirrored, transformed. Texture 1: roughness, 8 x 8,
/// nearest.
inline Scene make_small_scene(const SmallSceneOptions& options = {}) {
    Scene scene;
    scene.camera.to_world = look_at({0.3, -2.6, 1.8}, {0, 0.1, 0}, {0, 0, 1});
    scene.camera.fov_x = 38;
    scene.film = {16, 16, 0, 0, 16, 16, {options.filter, options.filter_radius}};

    Bitmap base = make_bitmap(4, options.gray ? 1 : 3, TextureFilter::kBilinear, 0.3f, 0.8f, 61);
    base.wrap = TextureWrap::kMirror;
    base.to_uv = {{1.7f, 0.2f, 0.13f, -0.1f, 1.3f, 0.4f}};
    if (options.gray) {
        base.channels = 3;
        std::vector<float> rgb;
        for (const float v : base.values) rgb.insert(rgb.end(), {v, v, v});
        base.values = rgb;
    }
    scene.textures = {base, make_bitmap(8, 1, TextureFilter::kNearest, 0.35f, 0.7f, 62)};
    Principled principled;
    principled.base_color.texture = {0};
    principled[PrincipledScalar::kRoughness].texture = {1};
    principled[PrincipledScalar::kMetallic].constant = 0.6f;
    Diffuse black;
    black.reflectance.constant = {0, 0, 0};
    scene.bsdfs = {principled, black};
    scene.materials = {{"floor", {0}, {0}}, {"light", {1}, {}}};

    scene.emitters = {AreaEmitter{{6, 5, 4}, {1}}, AreaEmitter{{4, 6, 8}, {2}},
                      ConstantEmitter{{0.3f, 0.3f, 0.4f}}};
    Sphere ball;
    ball.center = {-0.9f, 0.2f, 0.8f};
    ball.radius = 0.25f;
    scene.shapes = {{"floor", make_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), {0}, {}},
                    {"panel", make_quad({0.2f, -0.4f, 1.6f}, {0, 0.8f, 0}, {0.8f, 0, 0}), {1}, {0}},
                    {"ball", ball, {1}, {1}}};
    scene.parameters = {{"floor.base_color.data", {0}}, {"floor.roughness.data", {1}}};
    return scene;
}

/// Its floor.
inline Principled& floor_of(Scene& scene) { return std::get<Principled>(scene.bsdfs[0]); }

inline Theta theta_of(const Scene& scene) {
    Theta theta;
    for (const Parameter& p : scene.parameters) {
        const auto& b = std::get<Bitmap>(scene[p.texture]);
        theta.textures.push_back({p.texture, {b.width, b.height, b.channels, b.values}});
    }
    return theta;
}

/// An adjoint image. `mixed`: each channel has a sign of its own; otherwise they share one.
inline Image make_adjoint(const Scene& scene, std::uint32_t seed, bool mixed) {
    Image adjoint = make_image(scene.film.crop_width, scene.film.crop_height, 3);
    RandomSource random{seed};
    for (std::size_t i = 0; i < adjoint.values.size(); i += 3) {
        const float shared = random.next(-1, 1);
        for (std::size_t c = 0; c < 3; ++c)
            adjoint.values[i + c] =
                mixed ? random.next(-1, 1) : shared * (0.6f + 0.3f * static_cast<float>(c));
    }
    return adjoint;
}

}  // namespace burnish::test
