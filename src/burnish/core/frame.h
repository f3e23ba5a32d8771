// Orthonormal frames: z is the normal. `_local` vectors live in a frame, `_world` vectors do not.
#pragma once

#include "burnish/core/vec.h"

namespace burnish {

struct Frame {
    Vec3f s{1, 0, 0}, t{0, 1, 0}, n{0, 0, 1};
};

inline Vec3f to_local(const Frame& f, const Vec3f& v) {
    return {dot(v, f.s), dot(v, f.t), dot(v, f.n)};
}
inline Vec3f to_world(const Frame& f, const Vec3f& v) { return f.s * v.x + f.t * v.y + f.n * v.z; }

/// Any frame around the unit vector n (Duff et al. 2017, "Building an Orthonormal Basis,
/// Revisited"); the same tangent as Mitsuba chooses, which anisotropic BSDFs without texture
/// coordinates show.
inline Frame frame_from_normal(const Vec3f& n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    return {
        {sign * n.x * n.x * a + 1.0f, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

/// Frame around n whose s lies along the tangent dp_du; any frame where dp_du is degenerate.
inline Frame frame_from_tangent(const Vec3f& n, const Vec3f& dp_du) {
    const Vec3f s = dp_du - n * dot(n, dp_du);
    const float squared = length_squared(s);
    if (!(squared > 0.0f) || !std::isfinite(squared)) return frame_from_normal(n);
    const Vec3f unit = s * (1.0f / std::sqrt(squared));
    return {unit, cross(n, unit), n};
}

}  // namespace burnish
