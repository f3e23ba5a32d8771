// The small scene from several places and under several lights.
#pragma once

#include "optimize/small_problem.h"

namespace burnish::test {

/// Ids of the emitters, as a scene file would give them.
inline Scene scene_with_ids(int side) {
    Scene scene = small_scene_of(side);
    scene.emitter_ids = {"panel", "ball", "sky"};
    scene.sensors = {{"front", scene.camera, scene.film}, {"side", scene.camera, scene.film, 1}};
    scene.sensors[1].camera.to_world = look_at({2.4, 0.3, 1.9}, {0, 0, 0}, {0, 0, 1});
    return scene;
}

/// A pinhole camera above the floor.
inline Camera above() {
    Camera camera;
    camera.width = 20, camera.height = 14;
    camera.focal_x = 22, camera.focal_y = 24, camera.center_x = 9.5, camera.center_y = 7.25;
    camera.camera_to_world = {1, 0, 0, 0.1, 0, -1, 0, 0, 0, 0, -1, 3, 0, 0, 0, 1};
    return camera;
}

/// Four views of scene_with_ids, the last one held out.
inline Problem problem_with_views(const Scene& scene) {
    Problem problem = problem_of(scene);
    View from_side = problem.views[0], from_above = problem.views[0], held_out = problem.views[0];
    from_side.name = "side", from_side.camera = Sensor{"side"};
    from_side.lighting.emitters = {"ball", "sky"};
    from_above.name = "above", from_above.camera = above();
    from_above.image = make_image(20, 14, 3, 0.3f);
    from_above.exposure = ExposureFactors{1.5f, 1, 0.5f};
    held_out.name = "held out", held_out.held_out = true;
    problem.views.insert(problem.views.end(), {from_side, from_above, held_out});
    return problem;
}
inline Problem problem_with_views(int side = 16) {
    return problem_with_views(scene_with_ids(side));
}

/// The scene with textures of so many texels a side: several blocks for each of several processes.
inline Scene scene_with_textures(int side, int texels) {
    Scene scene = scene_with_ids(side);
    scene.textures = {make_bitmap(texels, 3, TextureFilter::kBilinear, 0.3f, 0.8f, 61),
                      make_bitmap(texels, 1, TextureFilter::kNearest, 0.35f, 0.7f, 62)};
    return scene;
}

}  // namespace burnish::test
