#include "shading/camera.h"

#include "core/angle.h"
#include "core/contract.h"

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
            {with_field(camera.lens, reach), corner, size, {axis(0), axis(1), axis(2)}},
            camera.lens.kind == LensKind::kPinhole ? CameraKind::kPinhole : CameraKind::kBent};
}

std::optional<Vec3<double>> bent_direction(const BentRays& bent,
                                           const Vec2<double>& film_position) {
    return undistort(bent.lens, {bent.corner.x + bent.size.x * film_position.x,
                                 bent.corner.y + bent.size.y * film_position.y});
}

namespace {

CameraRay<float> bent_ray(const CameraRays& c, const Vec2f& film_position) {
    const BentRays& b = c.bent;
    const auto local = bent_direction(b, {double{film_position.x}, double{film_position.y}});
    if (!local) return {c.eye, to_float(b.axes[2]), -1};
    const Vec3f direction =
        to_float(b.axes[0] * local->x + b.axes[1] * local->y + b.axes[2] * local->z);
    const float distance = sees_by_plane(b.lens.lens.kind) ? static_cast<float>(1 / local->z) : 1;
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

template <class T>
Vec3<T> wide(const Vec3f& v) {
    return {T(v.x), T(v.y), T(v.z)};
}

template <class T>
Vec3<T> on_film(const CameraRays& c, const Vec2<T>& film_position) {
    return wide<T>(c.corner) + wide<T>(c.across) * film_position.x +
           wide<T>(c.down) * film_position.y;
}

template <class T>
CameraRay<T> orthographic_ray(const CameraRays& c, const Vec2<T>& film_position) {
    const Vec3<T> forward = wide<T>(c.forward);
    return {wide<T>(c.eye) + on_film(c, film_position) + forward * T(c.near_clip), forward,
            T(c.far_clip - c.near_clip)};
}

/// Uniform on the lens.
template <class T>
CameraRay<T> thin_lens_ray(const CameraRays& c, const Vec2<T>& film_position,
                           const Vec2<T>& aperture) {
    const T radius = T(c.aperture_radius) * safe_sqrt(aperture.x);
    const SinCos<T> around = sin_cos_turns(aperture.y);
    const Vec3<T> on_lens = wide<T>(normalize(c.across)) * (radius * around.cos) +
                            wide<T>(normalize(c.down)) * (radius * around.sin);
    const Vec3<T> way = on_film(c, film_position) * T(c.focus_distance) - on_lens;
    const T far_away = length(way), along_z = far_away * T(1 / c.focus_distance);
    const Vec3<T> direction = way * (T(1.0f) / far_away);
    return {wide<T>(c.eye) + on_lens + direction * (T(c.near_clip) * along_z), direction,
            T(c.far_clip - c.near_clip) * along_z};
}

template <class T>
CameraRay<T> ray_of_kind(const CameraRays& c, const Vec2<T>& film_position,
                         const Vec2<T>& aperture) {
    switch (c.kind) {
        case CameraKind::kPinhole:  // of camera_ray
            BURNISH_REQUIRE(c.kind, !=, CameraKind::kPinhole);
            break;
        case CameraKind::kBent:
            return bent_ray(c, film_position);
        case CameraKind::kOrthographic:
            return orthographic_ray(c, film_position);
        case CameraKind::kThinLens:
            return thin_lens_ray(c, film_position, aperture);
    }
    return {};
}

}  // namespace

CameraRay<float> other_ray(const CameraRays& c, const Vec2f& film_position, const Vec2f& aperture) {
    return ray_of_kind(c, film_position, aperture);
}

CameraRay<Packet> other_ray(const CameraRays& c, const Vec2<Packet>& film_position,
                            const Vec2<Packet>& aperture) {
    return ray_of_kind(c, film_position, aperture);
}

}  // namespace burnish
