// A floor of smooth metal under a small lamp: which roughness it has follows from where the lamp is
// seen, and descent from 0.5 goes the wrong way.
#pragma once

#include <cmath>
#include <functional>

#include "burnish/solve.h"
#include "gradient/small_scene.h"
#include "render/renderer.h"
#include "shading/filter.h"

namespace burnish::test {

inline double distance_of(const Image& texels, const Image& truth) {
    double sum = 0;
    for (std::size_t i = 0; i < truth.values.size(); ++i)
        sum += std::pow(double{texels.values[i]} - double{truth.values[i]}, 2);
    return std::sqrt(sum / static_cast<double>(truth.values.size()));
}

/// A bitmap whose texels are f(x, y, channel).
inline Bitmap bitmap_of(int side, int channels, const std::function<float(int, int, int)>& f) {
    Bitmap bitmap = make_bitmap(side, channels, TextureFilter::kNearest, 0, 1, 1);
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            for (int c = 0; c < channels; ++c)
                bitmap.values[static_cast<std::size_t>((y * side + x) * channels + c)] = f(x, y, c);
    return bitmap;
}

/// A floor seen from above under one small panel: at most pixels the lamp is seen far from the
/// mirror direction.
inline Scene floor_scene(const Principled& floor, std::vector<Bitmap> textures) {
    Scene scene = make_small_scene();
    scene.film = {48, 48, 0, 0, 48, 48, {FilterKind::kGaussian, 2}};
    scene.textures.assign(textures.begin(), textures.end());
    scene.bsdfs[0] = floor;
    scene.shapes.pop_back();  // the ball
    scene.emitters = {AreaEmitter{{30, 30, 30}, {1}}, ConstantEmitter{{0.01f, 0.01f, 0.01f}}};
    scene.shapes[1] = {
        "panel", make_quad({-0.1f, 0.6f, 1.4f}, {0, 0.2f, 0}, {0.2f, 0, 0}), {1}, {0}};
    scene.parameters.clear();
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(textures.size()); ++i)
        scene.parameters.push_back({"texture " + std::to_string(i), {i}});
    return scene;
}

inline Principled metal() {
    Principled floor;
    floor.base_color.constant = {0.8f, 0.7f, 0.6f};
    floor[PrincipledScalar::kMetallic].constant = 1;
    return floor;
}

/// Smooth metal: 0.08 on the left, 0.15 on the right.
inline Scene smooth_scene() {
    Principled floor = metal();
    floor[PrincipledScalar::kRoughness].texture = {0};
    return floor_scene(floor,
                       {bitmap_of(16, 1, [](int x, int, int) { return x < 8 ? 0.08f : 0.15f; })});
}

/// The picture of the scene's own textures, to be matched from a start.
inline Problem searched_problem(const Scene& scene, Start start) {
    Problem problem{make_renderer(scene), {}, {}, {}};
    problem.views = {{problem.renderer.render(64, 1), {}}};
    for (const Parameter& p : scene.parameters) problem.unknowns.push_back({p.name, start});
    return problem;
}

inline Image truth_of(const Scene& scene, std::int32_t texture) {
    return linear_image(std::get<Bitmap>(scene.textures[static_cast<std::size_t>(texture)]));
}

}  // namespace burnish::test
