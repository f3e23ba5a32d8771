// A floor under lamps of every kind, bright and dim, near and far.
#pragma once

#include "gradient/small_scene.h"
#include "paths/trace.h"

namespace burnish::test {

inline constexpr std::array kSelections{LightSelection::kUniform, LightSelection::kPower,
                                        LightSelection::kTree, LightSelection::kResampled};

inline void add_lamp(Scene& scene, const Geometry& geometry, const Rgbf& radiance) {
    const auto shape = static_cast<std::int32_t>(scene.shapes.size()),
               emitter = static_cast<std::int32_t>(scene.emitters.size());
    scene.emitters.push_back(AreaEmitter{radiance, {shape}});
    scene.shapes.push_back({"lamp", geometry, {1}, {emitter}});
}

/// The small scene with more lamps: a disk, a point, and two rows of small panels that face down,
/// up and sideways, each twice as bright as the one before.
inline Scene make_lamps() {
    Scene scene = make_small_scene();
    scene.emitters.push_back(PointEmitter{{0.8f, -0.9f, 0.7f}, {0.2f, 0.3f, 0.2f}});
    Disk disk;
    disk.to_world =
        translation({0.7, 0.9, 0.6}) * rotation({1, 0, 0}, 130) * scaling({0.2, 0.1, 1});
    disk.to_local = inverse(disk.to_world);
    add_lamp(scene, disk, {9, 9, 12});
    float power = 0.25f;
    for (int i = 0; i < 9; ++i, power *= 2) {
        const float x = -0.9f + 0.2f * static_cast<float>(i), y = i % 2 ? -0.95f : 0.95f;
        const std::array<Vec3f, 3> second{{{0, 0.06f, 0}, {0, -0.06f, 0}, {0, 0, 0.06f}}};
        add_lamp(scene,
                 make_quad({x, y, 0.25f}, second[static_cast<std::size_t>(i % 3)], {0.06f, 0, 0}),
                 {power, power, 0.5f * power});
    }
    return scene;
}

/// Those lamps, and lights that no ray finds: two from infinity, a spot, a projector.
inline Scene make_beams() {
    Scene scene = make_lamps();
    scene.emitters.push_back(DirectionalEmitter{normalize(Vec3f{0.3f, 0.4f, -1}), {0.5f, 0.4f, 0}});
    SpotEmitter spot;
    spot.to_world = look_at({0.2, 0.3, 1.5}, {0, 0, 0}, {0, 1, 0});
    spot.intensity = {3, 2, 1};
    scene.emitters.push_back(spot);
    ProjectorEmitter projector;
    projector.to_world = look_at({-0.5, 0.4, 1.2}, {0, 0, 0}, {0, 1, 0});
    projector.irradiance = {0.2f, 0.3f, 0.4f};
    scene.emitters.push_back(projector);
    scene.emitters.push_back(DirectionalEmitter{{0, 0, -1}, {0.1f, 0.1f, 0.1f}});
    return scene;
}

/// Positions in the middle of the scene, and far outside.
inline Vec3f random_position(RandomSource& random) {
    const float size = random.next() < 0.9f ? 1.0f : 100.0f;
    return {random.next(-size, size), random.next(-size, size), random.next(-size, size)};
}

}  // namespace burnish::test
