// The goblet's shape: splines turned around the axis, relief, and how texture rows are spread.
#include "scenes/goblet.h"

#include <algorithm>
#include <numbers>

#include "scenes/scene_files.h"

namespace burnish::procedural {

namespace {

using Vec3d = Vec3<double>;
constexpr double kPi = std::numbers::pi;

/// (r, y) from the lip down to the edge of the foot.
constexpr Vec2<double> kKnots[kGobletKnots] = {
    {0.500, 1.720}, {0.490, 1.640}, {0.497, 1.500}, {0.515, 1.330}, {0.515, 1.180}, {0.470, 1.030},
    {0.360, 0.920}, {0.220, 0.850}, {0.115, 0.800}, {0.075, 0.730}, {0.095, 0.670}, {0.165, 0.625},
    {0.180, 0.570}, {0.150, 0.515}, {0.085, 0.465}, {0.068, 0.400}, {0.075, 0.300}, {0.110, 0.215},
    {0.200, 0.150}, {0.330, 0.110}, {0.440, 0.085}, {0.490, 0.055}, {0.490, 0.010}};

/// Inside of the bowl, from the lip to the bottom.
constexpr Vec2<double> kInsideKnots[] = {
    {0.500, 1.720}, {0.493, 1.727}, {0.482, 1.722}, {0.474, 1.640}, {0.480, 1.500}, {0.496, 1.330},
    {0.494, 1.180}, {0.446, 1.045}, {0.330, 0.945}, {0.180, 0.890}, {0.080, 0.875}, {0.0, 0.872}};
constexpr Vec2<double> kTableKnots[] = {{0.0, 0.0},    {0.6, 0.0},    {1.3, 0.0},    {1.86, 0.0},
                                        {1.92, -0.02}, {1.94, -0.06}, {1.92, -0.10}, {1.86, -0.12}};
constexpr Vec2<double> kLanternKnots[] = {{0.0, 1.5}, {0.12, 1.3}, {0.35, 0.95},  {0.75, 0.55},
                                          {1.0, 0.0}, {0.8, -0.6}, {0.35, -0.93}, {0.0, -1.0}};

/// Uniform Catmull-Rom spline through the knots; t in [0, count - 1].
Vec2<double> spline(const Vec2<double>* knots, int count, double t) {
    const int i = std::clamp(static_cast<int>(t), 0, count - 2);
    const double f = t - i;
    const auto at = [&](int j) {
        // Beyond an end the curve goes on straight.
        if (j < 0) return knots[0] * 2.0 - knots[1];
        if (j >= count) return knots[count - 1] * 2.0 - knots[count - 2];
        return knots[j];
    };
    const Vec2<double> p0 = at(i - 1), p1 = at(i), p2 = at(i + 1), p3 = at(i + 2);
    return (p1 * 2.0 + (p2 - p0) * f + (p0 * 2.0 - p1 * 5.0 + p2 * 4.0 - p3) * (f * f) +
            (p1 * 3.0 - p0 - p2 * 3.0 + p3) * (f * f * f)) *
           0.5;
}

/// Smooth bump: 1 inside [begin, end], 0 further away than `fade`.
double window(double k, double begin, double end, double fade) {
    const auto step = [](double x) {
        const double t = std::clamp(x, 0.0, 1.0);
        return t * t * (3 - 2 * t);
    };
    return step((k - begin) / fade + 1) * step((end - k) / fade + 1);
}

/// Height of the relief above the smooth wall.
double relief(double azimuth, double k) {
    const GobletBands band;
    double height = 0.006 * window(k, 0.12, 0.75, 0.12) * std::pow(std::cos(13.5 * azimuth), 2);
    height += 0.020 * window(k, band.belly + 0.5, band.gadroons - 0.8, 0.6) *
              std::fabs(std::sin(9 * azimuth));
    height +=
        0.012 * window(k, band.neck + 1, band.knop - 1, 0.7) * std::cos(9 * azimuth + 2.2 * k);
    height += 0.006 * window(k, band.stem + 0.6, band.foot - 0.3, 0.6) * std::cos(12 * azimuth);
    for (const float ring : {band.rim, band.frieze, band.belly, band.gadroons}) {
        height += 0.009 * std::exp(-std::pow((k - static_cast<double>(ring)) / 0.09, 2));
    }
    return height;
}

Vec3d turned(double radius, double y, double azimuth) {
    return {radius * std::sin(azimuth), y, radius * std::cos(azimuth)};
}

/// A curve turned around the y axis; `inward` faces the axis. uv = (x, z) over the square around
/// the curve's widest ring.
template <std::size_t N>
PatchMesh make_turned(const Vec2<double> (&knots)[N], int columns, int rows, bool inward = false) {
    double widest = 0;
    for (const Vec2<double>& knot : knots) widest = std::max(widest, knot.x);
    return tessellate(columns, rows, [&](double a, double b) {
        const Vec2<double> p = spline(knots, static_cast<int>(N), b * (N - 1.0));
        const Vec3d position = turned(std::max(p.x, 0.0), p.y, (inward ? -2 : 2) * kPi * a);
        return PatchPoint{position,
                          {0.5 + 0.5 * position.x / widest, 0.5 + 0.5 * position.z / widest}};
    });
}

}  // namespace

Vec2<double> goblet_curve(double knot) { return spline(kKnots, kGobletKnots, knot); }

GobletProfile make_goblet_profile() {
    // v grows with sqrt(r) along the curve: between equal steps on the wall and equal areas.
    constexpr int kSteps = 4096;
    std::vector<double> v(kSteps + 1);
    const auto knot = [](int i) { return (kGobletKnots - 1.0) * i / kSteps; };
    for (int i = 1; i <= kSteps; ++i) {
        const Vec2<double> p = goblet_curve(knot(i - 1)), q = goblet_curve(knot(i));
        v[static_cast<std::size_t>(i)] =
            v[static_cast<std::size_t>(i - 1)] +
            std::hypot(q.x - p.x, q.y - p.y) * std::sqrt(0.5 * (p.x + q.x));
    }
    GobletProfile profile;
    std::size_t i = 0;
    for (int row = 0; row <= kSteps; ++row) {
        const double wanted = v.back() * row / kSteps;
        while (i + 2 < v.size() && v[i + 1] < wanted) ++i;
        const double f = (wanted - v[i]) / (v[i + 1] - v[i]);
        profile.knot_of_row.push_back((kGobletKnots - 1.0) * (static_cast<double>(i) + f) / kSteps);
    }
    return profile;
}

double goblet_knot(const GobletProfile& profile, double v) {
    const double x = std::clamp(v, 0.0, 1.0) * static_cast<double>(profile.knot_of_row.size() - 1);
    const std::size_t i = std::min(static_cast<std::size_t>(x), profile.knot_of_row.size() - 2);
    return std::lerp(profile.knot_of_row[i], profile.knot_of_row[i + 1],
                     x - static_cast<double>(i));
}

PatchMesh make_goblet_wall() {
    const GobletProfile profile = make_goblet_profile();
    return tessellate(216, 150, [&](double a, double b) {
        const double k = goblet_knot(profile, b), azimuth = 2 * kPi * a, step = 1e-4;
        const Vec2<double> p = goblet_curve(k);
        const Vec2<double> tangent = goblet_curve(std::min(k + step, kGobletKnots - 1.0)) -
                                     goblet_curve(std::max(k - step, 0.0));
        const double lift = relief(azimuth, k) / std::hypot(tangent.x, tangent.y);
        return PatchPoint{turned(p.x - tangent.y * lift, p.y + tangent.x * lift, azimuth),
                          {kGobletRepeats * a, b}};
    });
}

PatchMesh make_goblet_inside() { return make_turned(kInsideKnots, 96, 40, true); }
PatchMesh make_table_top() { return make_turned(kTableKnots, 96, 28); }
PatchMesh make_lantern() { return make_turned(kLanternKnots, 24, 14); }

}  // namespace burnish::procedural
