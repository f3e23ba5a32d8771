// The small scene as a problem: base colour and roughness are recovered.
#pragma once

#include "burnish/solve.h"
#include "gradient/small_scene.h"
#include "render/renderer.h"

namespace burnish::test {

inline Scene small_scene_of(int side) {
    Scene scene = make_small_scene();
    scene.film.width = scene.film.height = scene.film.crop_width = scene.film.crop_height = side;
    return scene;
}

/// All textures of a scene as unknowns, which start from what they are.
inline Problem problem_of(const Scene& scene, float target = 0.2f) {
    Problem problem{make_renderer(scene), {}, {}};
    const Film& film = scene.film;
    problem.views = {{make_image(film.crop_width, film.crop_height, 3, target), {}}};
    const Theta theta = theta_of(scene);
    for (std::size_t i = 0; i < theta.textures.size(); ++i)
        problem.unknowns.push_back({scene.parameters[i].name, theta.textures[i].values, 0.05});
    return problem;
}

}  // namespace burnish::test
