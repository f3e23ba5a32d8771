#include "scenes/turned.h"

#include <algorithm>
#include <numbers>

namespace burnish::procedural {

namespace {

using Vec3d = Vec3<double>;
using std::numbers::pi;

double last_knot(Knots knots) { return static_cast<double>(knots.size() - 1); }

}  // namespace

Vec2<double> curve_point(Knots knots, double k) {
    const int count = static_cast<int>(knots.size());
    const int i = std::clamp(static_cast<int>(k), 0, count - 2);
    const double f = k - i;
    const auto at = [&](int j) {
        if (j < 0) return knots[0] * 2.0 - knots[1];
        if (j >= count) return knots[knots.size() - 1] * 2.0 - knots[knots.size() - 2];
        return knots[static_cast<std::size_t>(j)];
    };
    const Vec2<double> p0 = at(i - 1), p1 = at(i), p2 = at(i + 1), p3 = at(i + 2);
    return (p1 * 2.0 + (p2 - p0) * f + (p0 * 2.0 - p1 * 5.0 + p2 * 4.0 - p3) * (f * f) +
            (p1 * 3.0 - p0 - p2 * 3.0 + p3) * (f * f * f)) *
           0.5;
}

CurveRows spread_rows(Knots knots) {
    constexpr int kSteps = 4096;
    std::vector<double> v(kSteps + 1);
    const auto knot = [&](int i) { return last_knot(knots) * i / kSteps; };
    for (int i = 1; i <= kSteps; ++i) {
        const Vec2<double> p = curve_point(knots, knot(i - 1)), q = curve_point(knots, knot(i));
        v[static_cast<std::size_t>(i)] =
            v[static_cast<std::size_t>(i - 1)] +
            std::hypot(q.x - p.x, q.y - p.y) * std::sqrt(std::fmax(0.5 * (p.x + q.x), 0.0));
    }
    CurveRows rows;
    std::size_t i = 0;
    for (int row = 0; row <= kSteps; ++row) {
        const double wanted = v.back() * row / kSteps;
        while (i + 2 < v.size() && v[i + 1] < wanted) ++i;
        const double f = (wanted - v[i]) / (v[i + 1] - v[i]);
        rows.knot_of_row.push_back(last_knot(knots) * (static_cast<double>(i) + f) / kSteps);
    }
    return rows;
}

double knot_at(const CurveRows& rows, double v) {
    const double x = std::clamp(v, 0.0, 1.0) * static_cast<double>(rows.knot_of_row.size() - 1);
    const std::size_t i = std::min(static_cast<std::size_t>(x), rows.knot_of_row.size() - 2);
    return std::lerp(rows.knot_of_row[i], rows.knot_of_row[i + 1], x - static_cast<double>(i));
}

double window(double k, double begin, double end, double fade) {
    const auto step = [](double x) {
        const double t = std::clamp(x, 0.0, 1.0);
        return t * t * (3 - 2 * t);
    };
    return step((k - begin) / fade + 1) * step((end - k) / fade + 1);
}

Vec3d around_axis(double radius, double y, double azimuth) {
    return {radius * std::sin(azimuth), y, radius * std::cos(azimuth)};
}

Vec3d lifted_point(Knots knots, double k, double azimuth, double height) {
    const double step = 1e-4;
    const Vec2<double> p = curve_point(knots, k);
    const Vec2<double> tangent = curve_point(knots, std::min(k + step, last_knot(knots))) -
                                 curve_point(knots, std::max(k - step, 0.0));
    const double lift = height / std::hypot(tangent.x, tangent.y);
    return around_axis(p.x - tangent.y * lift, p.y + tangent.x * lift, azimuth);
}

Mesh make_turned(Knots knots, int columns, int rows, bool inward) {
    double widest = 0;
    for (const Vec2<double>& knot : knots) widest = std::max(widest, knot.x);
    return tessellate(columns, rows, [&](double a, double b) {
        const Vec2<double> p = curve_point(knots, b * last_knot(knots));
        const Vec3d position = around_axis(std::max(p.x, 0.0), p.y, (inward ? -2 : 2) * pi * a);
        return PatchPoint{position,
                          {0.5 + 0.5 * position.x / widest, 0.5 + 0.5 * position.z / widest}};
    });
}

}  // namespace burnish::procedural
