// The bowl's shape, and the lamp's.
#include "scenes/bowl.h"

#include <cmath>
#include <numbers>

namespace burnish::procedural {

namespace {

using std::numbers::pi;

/// (r, y) from the middle of the inside to the foot.
constexpr Vec2<double> kBowlProfile[] = {
    {0.000, 0.120}, {0.120, 0.116}, {0.240, 0.106}, {0.360, 0.098}, {0.470, 0.112}, {0.545, 0.158},
    {0.590, 0.225}, {0.622, 0.300}, {0.655, 0.352}, {0.710, 0.378}, {0.775, 0.376}, {0.825, 0.350},
    {0.842, 0.300}, {0.825, 0.235}, {0.775, 0.165}, {0.705, 0.105}, {0.655, 0.060}, {0.640, 0.000}};

double bowl_relief(double azimuth, double k) {
    const BowlBands band;
    double height = 0.010 * std::cos(8 * azimuth) * window(k, 0.9, 2.6, 0.8);
    height += 0.012 * std::fabs(std::sin(12 * azimuth)) * window(k, 4.8, 6.6, 0.7);
    height += 0.014 * std::fabs(std::cos(16 * azimuth)) * window(k, 12.6, 14.6, 0.7);
    for (const double ring : {band.rosette, band.lattice, band.flutes, band.waist})
        height += 0.008 * std::exp(-std::pow((k - ring) / 0.10, 2));
    return height;
}

/// How deep the rests lie below the rim: four round channels.
double rest(double azimuth, double k) {
    const double quarter = std::remainder(azimuth - pi / 4, pi / 2);
    return 0.075 * std::exp(-std::pow(quarter / 0.115, 2)) * window(k, 8.3, 10.6, 1.8);
}

}  // namespace

CurveRows make_bowl_rows() { return spread_rows(kBowlProfile); }

Mesh make_bowl() {
    constexpr int kColumns = 288, kRows = 170;
    const CurveRows rows = make_bowl_rows();
    const auto surface = [&](double a, double b) {
        const double k = knot_at(rows, b), azimuth = 2 * pi * a;
        Vec3<double> p = lifted_point(kBowlProfile, k, azimuth, bowl_relief(azimuth, k));
        p.y -= rest(azimuth, k);
        return PatchPoint{p, {b, kBowlRepeats * a}};
    };
    return tessellate(kColumns, kRows, surface, cell_step(kColumns, kRows));
}

Mesh make_ring_light() {
    return tessellate(64, 16, [](double a, double b) {
        const double turn = -2 * pi * b;
        return PatchPoint{
            around_axis(0.5 + 0.06 * std::cos(turn), 0.06 * std::sin(turn), 2 * pi * a), {a, b}};
    });
}

}  // namespace burnish::procedural
