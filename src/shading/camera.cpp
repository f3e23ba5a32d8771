#include "shading/camera.h"

namespace burnish {

CameraRays make_camera_rays(const Camera& camera, float near_clip, float far_clip) {
    const Matrix& m = camera.camera_to_world;
    const auto world = [&](double x, double y, double z) {
        const auto row = [&](std::size_t i) {
            return static_cast<float>(m[4 * i] * x + m[4 * i + 1] * y + m[4 * i + 2] * z);
        };
        return Vec3f{row(0), row(1), row(2)};
    };
    const auto axis = [&](std::size_t i) { return Vec3<double>{m[i], m[4 + i], m[8 + i]}; };
    const Vec3f eye{static_cast<float>(m[3]), static_cast<float>(m[7]), static_cast<float>(m[11])};
    const Vec2<double> corner{-camera.center_x / camera.focal_x, -camera.center_y / camera.focal_y},
        size{camera.width / camera.focal_x, camera.height / camera.focal_y};
    const double reach =
        std::hypot(std::max(-corner.x, corner.x + size.x), std::max(-corner.y, corner.y + size.y));
    return {eye,
            world(corner.x, corner.y, 1),
            world(size.x, 0, 0),
            world(0, size.y, 0),
            near_clip,
            far_clip,
            {with_field(camera.lens, reach), corner, size, {axis(0), axis(1), axis(2)}}};
}

std::optional<Vec3<double>> bent_direction(const BentRays& bent,
                                           const Vec2<double>& film_position) {
    return undistort(bent.lens, {bent.corner.x + bent.size.x * film_position.x,
                                 bent.corner.y + bent.size.y * film_position.y});
}

CameraRay<float> bent_ray(const CameraRays& c, const Vec2f& film_position) {
    const BentRays& b = c.bent;
    const auto narrow = [](const Vec3<double>& v) {
        return Vec3f{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
    };
    const auto local = bent_direction(b, {double{film_position.x}, double{film_position.y}});
    if (!local) return {c.eye, narrow(b.axes[2]), -1};
    const Vec3f direction =
        narrow(b.axes[0] * local->x + b.axes[1] * local->y + b.axes[2] * local->z);
    const bool by_plane = b.lens.lens.kind != LensKind::kFisheye;
    const float distance = by_plane ? static_cast<float>(1 / local->z) : 1;
    return {c.eye + direction * (c.near_clip * distance), direction,
            (c.far_clip - c.near_clip) * distance};
}

CameraRay<Packet> bent_ray(const CameraRays& c, const Vec2<Packet>& film_position) {
    CameraRay<Packet> rays;
    for (int i = 0; i < kLanes; ++i) {
        const CameraRay<float> ray =
            bent_ray(c, Vec2f{get(film_position.x, i), get(film_position.y, i)});
        for (int k = 0; k < 3; ++k) {
            set(rays.origin[k], i, ray.origin[k]);
            set(rays.direction[k], i, ray.direction[k]);
        }
        set(rays.max_distance, i, ray.max_distance);
    }
    return rays;
}

}  // namespace burnish
