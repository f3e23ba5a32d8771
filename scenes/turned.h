// Curves turned around the y axis: most shapes of the procedural scenes.
//
// A curve (r, y) is a Catmull-Rom spline through knots, so that a place on it is named by its *knot
// coordinate* k in [0, knots - 1]. Turned with azimuth 0 at +z and pi / 2 at +x, it faces the side
// on the left of its direction as drawn with r to the right and y up: a wall that goes down faces
// outward, a floor that goes outward faces up.
#pragma once

#include <span>
#include <vector>

#include "core/vec.h"
#include "scenes/scene_files.h"

namespace burnish::procedural {

using Knots = std::span<const Vec2<double>>;

/// Uniform Catmull-Rom spline through the knots; k in [0, count - 1]. Beyond an end it goes on
/// straight.
Vec2<double> curve_point(Knots knots, double k);

/// How texture rows are spread along a curve: v grows with sqrt(r) times the arc length, between
/// equal steps on the wall and equal areas.
struct CurveRows {
    std::vector<double> knot_of_row;  ///< uniform in v
};
CurveRows spread_rows(Knots knots);
/// v in [0, 1], clamped, to knot coordinate.
double knot_at(const CurveRows& rows, double v);

/// Smooth bump: 1 inside [begin, end], 0 further away than `fade`.
double window(double k, double begin, double end, double fade);

Vec3<double> around_axis(double radius, double y, double azimuth);

/// The curve's point turned to the azimuth and moved off the surface by `height`.
Vec3<double> lifted_point(Knots knots, double k, double azimuth, double height);

/// A smooth curve turned around the axis; `inward` turns it the other way, so that it faces the
/// other side. uv = (x, z) over the square around the curve's widest ring.
Mesh make_turned(Knots knots, int columns, int rows, bool inward = false);

}  // namespace burnish::procedural
