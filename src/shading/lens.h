// Lens distortion and its inverse, in double precision. What a lens does is said at Lens in
// burnish/view.h: it takes directions to distorted coordinates u, pixel = focal length u + centre.
//
// The Jacobian of Brown and Conrady's u(p) is symmetric. Where it is positive definite on a disc, u
// is the gradient of a convex function there, and therefore one to one: the lens's field is the
// largest such disc, and Newton's iteration finds the one p of it with u(p) = u. For a fisheye, u
// grows with the angle.
#pragma once

#include <array>
#include <optional>

#include "burnish/view.h"
#include "core/vec.h"

namespace burnish {

/// A lens with the field in which it is inverted.
struct FieldLens {
    static constexpr std::size_t kSteps = 128;

    Lens lens = {};
    double radius = 0;  ///< of the field: of |p|, or the angle to the axis; kPinhole: infinite
    double end = 0;     ///< |u| at the radius, without the tangential part
    /// Radii at |u| = i reach / kSteps, without the tangential part: where Newton's iteration
    /// starts.
    std::array<double, kSteps + 1> radii{};
    double reach = 0;
};

/// Whether all directions that it sees meet a plane in front of it: its radius is that of (x / z,
/// y / z). Otherwise it is the angle to the axis.
bool sees_by_plane(LensKind kind);

/// reach: |u| to which the film extends, above 0; beyond it, what is undone takes longer.
FieldLens with_field(const Lens& lens, double reach);

/// Distorted coordinates of a direction, of any length; z > 0, but for a fisheye. In or outside of
/// the field.
Vec2<double> distort(const Lens& lens, const Vec3<double>& direction);

/// The unit direction within the field that has these coordinates, or empty: there is none.
std::optional<Vec3<double>> undistort(const FieldLens& lens, const Vec2<double>& distorted);

}  // namespace burnish
