// A scene with one light of any kind, and what a ray finds of it.
#pragma once

#include "gradient/small_scene.h"
#include "paths/lights.h"
#include "paths/one_ray.h"

namespace burnish::test {

enum class LightKind {
    kQuad,
    kSphere,
    kFlippedSphere,
    kDisk,
    kConstant,
    kEnvironment,
    kCylinder,
    kFlippedCylinder,
    kTexturedQuad,
    kTexturedCylinder,
};

/// Those after the first six have entries of their own in the ledger.
inline bool is_late(LightKind kind) { return kind >= LightKind::kCylinder; }

/// Bright and dim parts, without steps.
inline Bitmap lamp_texture() {
    Bitmap bitmap;
    bitmap.width = bitmap.height = 4, bitmap.channels = 3;
    RandomSource random{5004};
    for (int i = 0; i < 48; ++i) bitmap.values.push_back(random.next(0.3f, 3.0f));
    return bitmap;
}

/// Beside the origin, or around it.
inline Cylinder make_cylinder(float size, bool flipped) {
    Cylinder cylinder;
    const double radius = 0.5 * double{size};
    cylinder.to_world =
        flipped ? translation({0.1, 0, -1}) * scaling({1.2 * double{size}, 1.2 * double{size}, 2})
                : translation({0.3, 0.2, 1.1}) * rotation({1, 1, 0}, 60) *
                      scaling({radius, radius, 1.3 * double{size}});
    cylinder.to_local = inverse(cylinder.to_world);
    cylinder.flip_normals = flipped;
    return cylinder;
}

inline EnvironmentEmitter small_sky() {
    Image sky = make_image(8, 5, 3);
    RandomSource random{5001};
    for (float& v : sky.values) v = random.next(0.1f, 3.0f);
    return {share(std::move(sky)), 1.0f, {}};
}

/// A scene with a point light first, so that the choice of the emitter matters, and one light of
/// that kind.
inline Scene make_light(LightKind kind, float size = 1) {
    Scene scene;
    scene.bsdfs = {Diffuse{}};
    scene.materials = {{"light", {0}, {}}};
    scene.emitters = {PointEmitter{{5, 5, 5}, {1, 1, 1}}};
    const Rgbf radiance{2, 3, 4};
    const auto add_shape = [&](const Geometry& geometry) {
        scene.emitters.push_back(AreaEmitter{radiance, {0}});
        scene.shapes.push_back({"light", geometry, {0}, {1}});
    };
    switch (kind) {
        case LightKind::kQuad:
            add_shape(make_quad({-0.8f * size, -0.5f * size, 1.5f}, {0.2f, 1.1f * size, 0.3f},
                                {1.4f * size, 0, -0.2f}));
            break;
        case LightKind::kSphere:
        case LightKind::kFlippedSphere: {
            Sphere sphere;
            sphere.center = {0.5f, 0.6f, 1.2f};
            sphere.radius = 0.7f * size;
            if (kind == LightKind::kFlippedSphere) {  // lit from within
                sphere.center = {0, 0, 0};
                sphere.flip_normals = true;
            }
            add_shape(sphere);
            break;
        }
        case LightKind::kDisk: {
            Disk disk;
            disk.to_world = translation({0.1, 0.3, 1.4}) * rotation({1, 0, 0}, 160) *
                            scaling({0.9 * double{size}, 0.5 * double{size}, 1});
            disk.to_local = inverse(disk.to_world);
            add_shape(disk);
            break;
        }
        case LightKind::kCylinder:
        case LightKind::kFlippedCylinder:
            add_shape(make_cylinder(size, kind == LightKind::kFlippedCylinder));
            break;
        case LightKind::kTexturedQuad:
        case LightKind::kTexturedCylinder:
            scene = make_light(
                kind == LightKind::kTexturedQuad ? LightKind::kQuad : LightKind::kCylinder, size);
            scene.textures = {lamp_texture()};
            std::get<AreaEmitter>(scene.emitters[1]).texture = {0};
            break;
        case LightKind::kConstant:
            scene.emitters.push_back(ConstantEmitter{radiance});
            break;
        case LightKind::kEnvironment:
            scene.emitters.push_back(small_sky());
            std::get<EnvironmentEmitter>(scene.emitters.back()).to_world = rotation({1, 1, 0}, 40);
            break;
    }
    return scene;
}

/// What is emitted towards `origin` from along a direction, and the density of its sample.
inline EmissionSample emission_along(const TracedScene& traced, const Vec3f& origin,
                                     const Vec3f& direction) {
    const Hit hit = first_hit(traced.geometry->accel, origin, direction);
    return hit.shape < 0 ? emission_at_infinity(*traced.lights, origin, direction)
                         : emission_at_hit(*traced.lights, hit, origin, direction);
}

}  // namespace burnish::test
