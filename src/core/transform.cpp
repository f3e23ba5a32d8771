#include "core/transform.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace burnish {

Transform operator*(const Transform& a, const Transform& b) {
    Transform r;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            double sum = 0;
            for (int k = 0; k < 4; ++k) sum += a(i, k) * b(k, j);
            r(i, j) = sum;
        }
    return r;
}

Transform inverse(const Transform& a) {
    // Gauss-Jordan with partial pivoting.
    Transform m = a, r;
    for (int column = 0; column < 4; ++column) {
        int pivot = column;
        for (int row = column + 1; row < 4; ++row)
            if (std::abs(m(row, column)) > std::abs(m(pivot, column))) pivot = row;
        if (m(pivot, column) == 0 || !std::isfinite(m(pivot, column)))
            throw std::domain_error("the matrix has no inverse");
        for (int j = 0; j < 4; ++j) {
            std::swap(m(column, j), m(pivot, j));
            std::swap(r(column, j), r(pivot, j));
        }
        const double scale = 1 / m(column, column);
        for (int j = 0; j < 4; ++j) m(column, j) *= scale, r(column, j) *= scale;
        for (int row = 0; row < 4; ++row) {
            if (row == column) continue;
            const double factor = m(row, column);
            for (int j = 0; j < 4; ++j)
                m(row, j) -= factor * m(column, j), r(row, j) -= factor * r(column, j);
        }
    }
    return r;
}

double determinant3(const Transform& a) {
    return a(0, 0) * (a(1, 1) * a(2, 2) - a(1, 2) * a(2, 1)) -
           a(0, 1) * (a(1, 0) * a(2, 2) - a(1, 2) * a(2, 0)) +
           a(0, 2) * (a(1, 0) * a(2, 1) - a(1, 1) * a(2, 0));
}

bool is_rigid(const Transform& a, double tolerance) {
    if (!std::all_of(a.m.begin(), a.m.end(), [](double v) { return std::isfinite(v); }))
        return false;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const double product = a(0, i) * a(0, j) + a(1, i) * a(1, j) + a(2, i) * a(2, j);
            if (std::abs(product - (i == j)) > tolerance) return false;
        }
    return determinant3(a) > 0 && a(3, 0) == 0 && a(3, 1) == 0 && a(3, 2) == 0 && a(3, 3) == 1;
}

Transform orthonormalised(const Transform& a) {
    const Vec3<double> z = normalize(column_of(a, 2));
    const Vec3<double> y = normalize(column_of(a, 1) - z * dot(z, column_of(a, 1)));
    const Vec3<double> right = cross(y, z), x = determinant3(a) < 0 ? -right : right;
    Transform result = a;
    for (int i = 0; i < 3; ++i) result(i, 0) = x[i], result(i, 1) = y[i], result(i, 2) = z[i];
    return result;
}

namespace {
Vec3f apply(const Transform& a, const Vec3f& v, double w) {
    const auto row = [&](int i) {
        return static_cast<float>(a(i, 0) * v.x + a(i, 1) * v.y + a(i, 2) * v.z + a(i, 3) * w);
    };
    return {row(0), row(1), row(2)};
}
}  // namespace

Vec3f transform_point(const Transform& a, const Vec3f& p) { return apply(a, p, 1); }
Box transform_box(const Transform& a, const Box& box) {
    Box all;
    if (box.empty()) return all;
    for (int corner = 0; corner < 8; ++corner)
        all.include(transform_point(
            a, {corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                corner & 4 ? box.high.z : box.low.z}));
    return all;
}
Vec3f transform_vector(const Transform& a, const Vec3f& v) { return apply(a, v, 0); }

Vec3f transform_normal(const Transform& inv, const Vec3f& n) {
    const auto column = [&](int i) {
        return static_cast<float>(inv(0, i) * n.x + inv(1, i) * n.y + inv(2, i) * n.z);
    };
    return normalize(Vec3f{column(0), column(1), column(2)});
}

Transform translation(const Vec3<double>& t) {
    Transform r;
    r(0, 3) = t.x, r(1, 3) = t.y, r(2, 3) = t.z;
    return r;
}

Transform scaling(const Vec3<double>& s) {
    Transform r;
    r(0, 0) = s.x, r(1, 1) = s.y, r(2, 2) = s.z;
    return r;
}

Transform rodrigues(const Vec3<double>& a, double degrees) {
    const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle),
                 k = 1 - c;
    Transform r;
    r(0, 0) = c + a.x * a.x * k, r(0, 1) = a.x * a.y * k - a.z * s,
         r(0, 2) = a.x * a.z * k + a.y * s;
    r(1, 0) = a.y * a.x * k + a.z * s, r(1, 1) = c + a.y * a.y * k,
         r(1, 2) = a.y * a.z * k - a.x * s;
    r(2, 0) = a.z * a.x * k - a.y * s, r(2, 1) = a.z * a.y * k + a.x * s,
         r(2, 2) = c + a.z * a.z * k;
    return r;
}

Transform rotation(const Vec3<double>& axis, double degrees) {
    return rodrigues(normalize(axis), degrees);
}

Transform rotation(double w, double x, double y, double z) {
    Transform r;
    r(0, 0) = 1 - 2 * (y * y + z * z), r(0, 1) = 2 * (x * y - w * z), r(0, 2) = 2 * (x * z + w * y);
    r(1, 0) = 2 * (x * y + w * z), r(1, 1) = 1 - 2 * (x * x + z * z), r(1, 2) = 2 * (y * z - w * x);
    r(2, 0) = 2 * (x * z - w * y), r(2, 1) = 2 * (y * z + w * x), r(2, 2) = 1 - 2 * (x * x + y * y);
    return r;
}

Transform look_at(const Vec3<double>& origin, const Vec3<double>& target, const Vec3<double>& up) {
    const Vec3<double> z = normalize(target - origin);
    Vec3<double> x = cross(up, z);
    if (!(length_squared(x) > 0))
        x = std::abs(z.x) < 0.9 ? cross({1, 0, 0}, z) : cross({0, 1, 0}, z);
    x = normalize(x);
    const Vec3<double> y = cross(z, x);
    Transform r;
    for (int i = 0; i < 3; ++i) r(i, 0) = x[i], r(i, 1) = y[i], r(i, 2) = z[i], r(i, 3) = origin[i];
    return r;
}

}  // namespace burnish
