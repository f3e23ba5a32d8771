// Transform elements: translate, scale, rotate, lookat, matrix, composed by multiplication from the
// left in document order.
#pragma once

#include "core/transform.h"
#include "mitsuba/node.h"

namespace burnish::mitsuba {

/// `value` (1 or 3 numbers) or x, y, z, where a missing one is `missing`. Throws InputError.
Vec3<double> read_vector(const Node& node, double missing);

/// The content of a <transform>. Throws InputError.
Transform read_transform(const Node& node);

/// How a matrix scales: its columns' mean length, and whether it is that times an orthogonal matrix
/// up to `tolerance` (relative).
struct UniformScale {
    double scale = 1;
    bool uniform = true;
    bool mirrored = false;
};
UniformScale uniform_scale(const Transform& a, double tolerance);

/// The nearest-by-columns orthogonal matrix of the upper-left 3x3 (Gram-Schmidt; a mirror stays
/// one), same translation.
Transform orthonormalised(const Transform& a);

}  // namespace burnish::mitsuba
