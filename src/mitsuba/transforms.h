// Transform elements: translate, scale, rotate, lookat, matrix, composed by multiplication from the
// left in document order.
#pragma once

#include <optional>

#include "core/transform.h"
#include "mitsuba/node.h"

namespace burnish::mitsuba {

/// `value` (1 or 3 numbers) or x, y, z, where a missing one is `missing`. Throws InputError.
Vec3<double> read_vector(const Node& node, double missing);

/// The content of a <transform>. Throws InputError. As in Mitsuba 3, a <rotate> whose axis is not
/// of unit length is no rotation: Rodrigues' formula with that axis scales and shears.
Transform read_transform(const Node& node);

/// What Mitsuba takes for the inverse of such a matrix is its transpose, by which it moves normals:
/// the inverse in that sense of a <transform> that has such a <rotate>; empty for all others.
std::optional<Transform> read_skewed_inverse(const Node& node);

/// How a matrix scales: its columns' mean length, and whether it is that times an orthogonal matrix
/// up to `tolerance` (relative).
struct UniformScale {
    double scale = 1;
    bool uniform = true;
    bool mirrored = false;
};
UniformScale uniform_scale(const Transform& a, double tolerance);

}  // namespace burnish::mitsuba
