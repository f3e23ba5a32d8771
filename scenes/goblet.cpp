// The goblet's shape: splines turned around the axis, and relief.
#include "scenes/goblet.h"

#include <numbers>

#include "scenes/scene_files.h"

namespace burnish::procedural {

namespace {

using std::numbers::pi;

/// (r, y) from the lip down to the edge of the foot.
constexpr Vec2<double> kGobletProfile[kGobletKnots] = {
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

/// Height of the relief above the smooth wall.
double goblet_relief(double azimuth, double k) {
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

}  // namespace

CurveRows make_goblet_rows() { return spread_rows(kGobletProfile); }

Mesh make_goblet_wall() {
    const CurveRows rows = make_goblet_rows();
    return tessellate(216, 150, [&](double a, double b) {
        const double k = knot_at(rows, b), azimuth = 2 * pi * a;
        return PatchPoint{lifted_point(kGobletProfile, k, azimuth, goblet_relief(azimuth, k)),
                          {kGobletRepeats * a, b}};
    });
}

Mesh make_goblet_inside() { return make_turned(kInsideKnots, 96, 40, true); }
Mesh make_table_top() { return make_turned(kTableKnots, 96, 28); }
Mesh make_lantern() { return make_turned(kLanternKnots, 24, 14); }

}  // namespace burnish::procedural
