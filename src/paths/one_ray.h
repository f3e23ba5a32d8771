// Single rays, and the point that one from the camera meets: for the reference, for tests and for
// what the program says of a scene. Rendering traces packets.
#pragma once

#include <limits>

#include "core/contract.h"
#include "paths/layers.h"
#include "paths/trace.h"

namespace burnish {

inline RayPacket packet_of(const Vec3f& origin, const Vec3f& direction, float max_distance) {
    RayPacket packet;
    packet.valid.fill(0);
    packet.valid[0] = -1;
    for (auto* a : {&packet.origin_x, &packet.origin_y, &packet.origin_z, &packet.direction_x,
                    &packet.direction_y, &packet.direction_z, &packet.max_distance})
        a->fill(0);
    packet.origin_x[0] = origin.x, packet.origin_y[0] = origin.y, packet.origin_z[0] = origin.z;
    packet.direction_x[0] = direction.x, packet.direction_y[0] = direction.y;
    packet.direction_z[0] = direction.z, packet.max_distance[0] = max_distance;
    return packet;
}

inline Hit first_hit(const Accel& accel, const Vec3f& origin, const Vec3f& direction,
                     float max_distance = std::numeric_limits<float>::infinity()) {
    return hit_of(
        accel.intersect(packet_of(origin, direction, max_distance), Coherence::kIncoherent), 0);
}

inline bool is_occluded(const Accel& accel, const Vec3f& origin, const Vec3f& direction,
                        float max_distance) {
    return accel.occluded(packet_of(origin, direction, max_distance), Coherence::kIncoherent)[0] !=
           0;
}

/// The camera's ray through a pixel of the crop window, at a position in [0, 1)^2 within it.
inline CameraRay<float> camera_ray(const TracedScene& traced, std::uint32_t pixel,
                                   const Vec2f& within) {
    BURNISH_REQUIRE(has_aperture(traced.camera), ==, false);  // says nothing of the place on it
    const Film& film = traced.film;
    const auto width = static_cast<std::uint32_t>(film.crop_width);
    const auto place = [](std::uint32_t i, float in_pixel, int crop, int size) {
        return (static_cast<float>(i) + in_pixel + static_cast<float>(crop)) *
               (1 / static_cast<float>(size));
    };
    return camera_ray(traced.camera,
                      Vec2f{place(pixel % width, within.x, film.crop_x, film.width),
                            place(pixel / width, within.y, film.crop_y, film.height)});
}

/// A surface as the camera sees it.
struct SeenPoint {
    Surface surface;
    BsdfId bsdf;
    float side = 1;               ///< -1: a two-sided material seen from behind, local z mirrored
    Vec3f wi;                     ///< to the camera, local
    float share = 1, chance = 1;  ///< as of ShownMaterial
    const NormalMap* normals = nullptr;
    Vec3f old_normal{};  ///< before the map turned it

    /// What the normal map leaves of the light from a direction.
    float share_of_light(const Vec3f& direction) const {
        if (!normals) return 1;
        return burnish::share_of_light(*normals, old_normal, surface.shading.n, direction);
    }
    Vec3f to_local(const Vec3f& world) const {
        const Vec3f v = burnish::to_local(surface.shading, world);
        return {v.x, v.y, v.z * side};
    }
    Vec3f to_world(const Vec3f& local) const {
        return burnish::to_world(surface.shading, Vec3f{local.x, local.y, local.z * side});
    }
    /// The origin of a ray that leaves it.
    Vec3f leave(const Vec3f& direction) const {
        return leave_surface(surface.position, surface.geometric_normal, direction);
    }
};

/// hit: a valid one of the camera's ray.
inline SeenPoint seen_point(const TracedScene& traced, const TextureTable& textures,
                            const UnknownWeights& unknowns, const CameraRay<float>& ray,
                            const Hit& hit) {
    const Scene& scene = *traced.scene;
    SeenPoint p;
    p.surface = surface_at(scene, traced.geometry->triangles, hit, ray.origin, ray.direction);
    const LayeredPoint at{ray.origin, ray.direction, p.surface.uv};
    const ShownMaterial shown = shown_material(
        scene, textures, scene.shapes[static_cast<std::size_t>(hit.shape)].material, at, unknowns);
    const Material& material = scene[shown.material];
    p.share = shown.share, p.chance = shown.chance;
    p.bsdf = material.front;
    if (material.normals) {
        p.normals = &*material.normals;
        const TurnedFrame turned =
            turned_frame(*material.normals, scene, textures, hit, p.surface, ray.direction);
        p.old_normal = turned.old_normal;
        p.surface.shading = turned.shading;
    }
    p.wi = p.to_local(-ray.direction);
    if (material.has_sides() && p.wi.z < 0) p.bsdf = material.back, p.side = -1, p.wi.z = -p.wi.z;
    return p;
}

/// Whether something lies between the point and a point of light that was sampled for it.
inline bool is_blocked(const Accel& accel, const SeenPoint& p, const LightSample& light) {
    const Vec3f origin = p.leave(light.direction_world);
    if (!std::isfinite(light.distance))
        return is_occluded(accel, origin, light.direction_world, light.distance);
    const Vec3f way = p.surface.position + light.direction_world * light.distance - origin;
    return is_occluded(accel, origin, way * (1 / length(way)),
                       length(way) * (1 - kShadowShortening));
}

}  // namespace burnish
