// Affine transforms, composed and inverted in double, applied in float.
#pragma once

#include <array>

#include "core/box.h"
#include "core/vec.h"

namespace burnish {

/// Row-major 4x4 matrix acting on column vectors.
struct Transform {
    std::array<double, 16> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    double operator()(int row, int column) const {
        return m[static_cast<std::size_t>(4 * row + column)];
    }
    double& operator()(int row, int column) {
        return m[static_cast<std::size_t>(4 * row + column)];
    }
};

/// Its upper three numbers.
inline Vec3<double> column_of(const Transform& a, int i) { return {a(0, i), a(1, i), a(2, i)}; }
Transform operator*(const Transform& a, const Transform& b);
/// Throws std::domain_error where the matrix has no inverse.
Transform inverse(const Transform& a);
double determinant3(const Transform& a);  ///< of the upper-left 3x3
/// Whether it turns and moves without scaling, shearing or mirroring: products of its columns are
/// those of a rotation to the tolerance.
bool is_rigid(const Transform& a, double tolerance = 1e-3);
/// The nearest-by-columns orthogonal matrix of the upper-left 3x3 (Gram-Schmidt; a mirror stays
/// one), same translation.
Transform orthonormalised(const Transform& a);

Vec3f transform_point(const Transform& a, const Vec3f& p);
/// Around the corners, transformed; empty of an empty one.
Box transform_box(const Transform& a, const Box& box);
Vec3f transform_vector(const Transform& a, const Vec3f& v);
/// Multiplies by the transposed inverse and normalises; pass the *inverse* transform.
Vec3f transform_normal(const Transform& inverse_of_a, const Vec3f& n);

Transform translation(const Vec3<double>& t);
Transform scaling(const Vec3<double>& s);
/// Rodrigues' formula, c I + (1 - c) a a^T + s [a]x: a rotation where the axis a is of unit length;
/// with others it scales and shears.
Transform rodrigues(const Vec3<double>& a, double degrees);
Transform rotation(const Vec3<double>& axis, double degrees);  ///< of an axis of any length
/// Of the unit quaternion w + x i + y j + z k.
Transform rotation(double w, double x, double y, double z);
/// Camera-style frame: +z from origin to target, x (left) = up x z, y = z x x. A degenerate up
/// gives any frame.
Transform look_at(const Vec3<double>& origin, const Vec3<double>& target, const Vec3<double>& up);

}  // namespace burnish
