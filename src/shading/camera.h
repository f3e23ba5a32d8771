// Rays of a camera. Of a pinhole, the direction before normalisation is affine in the film
// position, so a camera is three vectors: d(x, y) = corner + x across + y down, with local z = 1.
// As in Mitsuba, rays start on the near plane and end on the far plane; of a fisheye, which sees
// what no plane does, they start and end at these distances. Film positions are fractions of the
// *whole* film, (0, 0) its top left corner.
//
// An orthographic camera's rays start on a plane and are parallel; its directions do not depend on
// the film position, its origins do. Rays of a thin lens start at a point of the lens and pass what
// the pinhole's ray meets at the focus distance.
//
// Outside of a lens's field there is no ray: its far end lies before its start, so it meets
// nothing, and nothing is seen along it, not even an environment.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "burnish/view.h"
#include "core/packet.h"
#include "scene/camera.h"
#include "shading/lens.h"

namespace burnish {

/// What a lens needs beside it: where the film lies in its distorted coordinates, and the camera's
/// axes x (right), y (down), z (forward), world.
struct BentRays {
    FieldLens lens = {};
    Vec2<double> corner = {}, size = {};
    std::array<Vec3<double>, 3> axes = {};
};

/// To add one: here and in make_camera_rays, its numbers in scene/camera.h, its sensor in
/// mitsuba/sensor.cpp, what it sees in render/visible_pixels.cpp, and where the compiler asks.
enum class CameraKind { kPinhole, kBent, kOrthographic, kThinLens };

/// A camera and a film, ready to make rays.
struct CameraRays {
    Vec3f eye;                   ///< the pinhole, world
    Vec3f corner, across, down;  ///< world; see above; without the lens; of an orthographic camera
                                 ///< the way from its eye to where rays start
    float near_clip, far_clip;   ///< along local z, or of a fisheye along the ray
    BentRays bent = {};          ///< where the camera has a lens
    CameraKind kind = CameraKind::kPinhole;
    Vec3f forward = {};  ///< unit; of an orthographic camera
    float aperture_radius = 0, focus_distance = 0;
};

inline bool has_lens(const CameraRays& c) { return c.kind == CameraKind::kBent; }
inline bool has_aperture(const CameraRays& c) { return c.kind == CameraKind::kThinLens; }

/// The width, in the world, of what a film shows at the distance 1 of its camera, or of an
/// orthographic one at any.
inline double width_at_one(const PerspectiveCamera& camera) {
    if (camera.orthographic_width > 0) return camera.orthographic_width;
    return 2 * std::tan(camera.fov_x * std::numbers::pi / 360);
}

inline CameraRays make_camera_rays(const PerspectiveCamera& camera, const Film& film) {
    const double width = width_at_one(camera);
    const double height = width * film.height / film.width;
    // +x is left and +y up in the image; film x goes right and film y down.
    const double left = (0.5 - camera.principal_offset_x) * width;
    const double top = (0.5 - camera.principal_offset_y) * height;
    const Transform& m = camera.to_world;
    const auto world = [&](double x, double y, double z) {
        const auto row = [&](int i) {
            return static_cast<float>(m(i, 0) * x + m(i, 1) * y + m(i, 2) * z);
        };
        return Vec3f{row(0), row(1), row(2)};
    };
    const bool orthographic = camera.orthographic_width > 0;
    CameraRays rays{transform_point(m, {0, 0, 0}),
                    world(left, top, orthographic ? 0 : 1),
                    world(-width, 0, 0),
                    world(0, -height, 0),
                    camera.near_clip,
                    camera.far_clip};
    rays.forward = world(0, 0, 1);
    if (orthographic) {
        rays.kind = CameraKind::kOrthographic;
    } else if (camera.aperture_radius > 0) {
        rays.kind = CameraKind::kThinLens;
        rays.aperture_radius = camera.aperture_radius, rays.focus_distance = camera.focus_distance;
    }
    return rays;
}

/// camera: of a film as large as its picture. near_clip, far_clip: along the viewing direction.
CameraRays make_camera_rays(const Camera& camera, float near_clip, float far_clip);

/// The parts of a ray, for T = float or Packet.
template <class T>
struct CameraRay {
    Vec3<T> origin, direction;  ///< world; direction is unit
    T max_distance;             ///< to the far plane; below 0: there is no ray
};

/// The local direction at a film position of a camera with a lens; empty: outside of its field.
std::optional<Vec3<double>> bent_direction(const BentRays& bent, const Vec2<double>& film_position);
/// The ray of a camera that is no pinhole.
CameraRay<float> other_ray(const CameraRays& c, const Vec2f& film_position, const Vec2f& aperture);
CameraRay<Packet> other_ray(const CameraRays& c, const Vec2<Packet>& film_position,
                            const Vec2<Packet>& aperture);

/// aperture: of a thin lens, two uniforms in [0, 1); (0, 0) is its centre.
template <class T>
CameraRay<T> camera_ray(const CameraRays& c, const Vec2<T>& film_position,
                        const Vec2<T>& aperture = {T(0.0f), T(0.0f)}) {
    if (c.kind != CameraKind::kPinhole) return other_ray(c, film_position, aperture);
    const auto wide = [](const Vec3f& v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
    const Vec3<T> d =
        wide(c.corner) + wide(c.across) * film_position.x + wide(c.down) * film_position.y;
    const T distance = length(d);  // from the pinhole to local z = 1
    const Vec3<T> direction = d * (T(1.0f) / distance);
    return {wide(c.eye) + direction * (T(c.near_clip) * distance), direction,
            T(c.far_clip - c.near_clip) * distance};
}

/// One ray; the slow form that prepares the camera each time.
inline CameraRay<float> camera_ray(const PerspectiveCamera& camera, const Film& film,
                                   const Vec2f& film_position) {
    return camera_ray(make_camera_rays(camera, film), film_position);
}

}  // namespace burnish
