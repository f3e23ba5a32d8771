// Orthonormal frames: z is the normal. `_local` vectors live in a frame, `_world` vectors do not.
// T: float, or Packet for sixteen frames.
#pragma once

#include <limits>

#include "core/vec.h"

namespace burnish {

template <class T>
struct FrameOf {
    Vec3<T> s{T(1), T(0), T(0)}, t{T(0), T(1), T(0)}, n{T(0), T(0), T(1)};
};
using Frame = FrameOf<float>;

template <class T>
Vec3<T> to_local(const FrameOf<T>& f, const Vec3<T>& v) {
    return {dot(v, f.s), dot(v, f.t), dot(v, f.n)};
}
template <class T>
Vec3<T> to_world(const FrameOf<T>& f, const Vec3<T>& v) {
    return f.s * v.x + f.t * v.y + f.n * v.z;
}

/// Any frame around the unit vector n (Duff et al. 2017, "Building an Orthonormal Basis,
/// Revisited"); the same tangent as Mitsuba chooses, which anisotropic BSDFs without texture
/// coordinates show.
template <class T>
FrameOf<T> frame_from_normal(const Vec3<T>& n) {
    const T one(1.0f), sign = mulsign(one, n.z);
    const T a = -one / (sign + n.z);
    const T b = n.x * n.y * a;
    return {
        {sign * n.x * n.x * a + one, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

/// Frame around n whose s lies along the tangent dp_du; any frame where dp_du is degenerate.
template <class T>
FrameOf<T> frame_from_tangent(const Vec3<T>& n, const Vec3<T>& dp_du) {
    const Vec3<T> s = dp_du - n * dot(n, dp_du);
    const T squared = length_squared(s);
    const auto proper = squared > T(0.0f) && squared <= T(std::numeric_limits<float>::max());
    const Vec3<T> unit = s * (T(1.0f) / sqrt(select(proper, squared, T(1.0f))));
    const FrameOf<T> along{unit, cross(n, unit), n};
    if (all(proper)) return along;
    const FrameOf<T> any_frame = frame_from_normal(n);
    return {select(proper, along.s, any_frame.s), select(proper, along.t, any_frame.t), n};
}

}  // namespace burnish
