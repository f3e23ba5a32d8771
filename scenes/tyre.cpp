// The tyre's shape: profile, tread, letters, and the wheel inside.
#include "scenes/tyre.h"

#include <cmath>
#include <numbers>

#include "scenes/lettering.h"

namespace burnish::procedural {

namespace {

using std::numbers::pi;

/// (r, y) from the upper bead to the lower one.
constexpr Vec2<double> kTyreProfile[] = {
    {0.575, 0.175},  {0.590, 0.215},  {0.620, 0.236},  {0.660, 0.246},  {0.715, 0.266},
    {0.775, 0.280},  {0.840, 0.280},  {0.905, 0.264},  {0.955, 0.228},  {0.983, 0.178},
    {0.996, 0.110},  {1.000, 0.037},  {1.000, -0.037}, {0.996, -0.110}, {0.983, -0.178},
    {0.955, -0.228}, {0.905, -0.264}, {0.840, -0.280}, {0.775, -0.280}, {0.715, -0.266},
    {0.660, -0.246}, {0.620, -0.236}, {0.590, -0.215}, {0.575, -0.175}};

constexpr Vec2<double> kWheelKnots[] = {
    {0.000, 0.125}, {0.050, 0.122}, {0.085, 0.105}, {0.100, 0.070}, {0.130, 0.058}, {0.200, 0.066},
    {0.300, 0.085}, {0.400, 0.110}, {0.470, 0.125}, {0.500, 0.140}, {0.525, 0.185}, {0.550, 0.222},
    {0.575, 0.236}, {0.597, 0.232}, {0.604, 0.210}, {0.600, 0.150}};

/// Distance of x from the nearest whole number.
double from_whole(double x) { return std::fabs(x - std::round(x)); }

double tyre_relief(double s, double k) {
    const TyreBands band;
    double height = -0.024 * tyre_grooves(s, k) + 0.011 * tyre_letters(s, k);
    for (const double ring : {band.rib, band.letters_end + 0.2, band.shoulder})
        height += 0.007 * std::exp(-std::pow((k - ring) / 0.10, 2));
    height += 0.005 * window(k, band.serration + 0.15, band.shoulder - 0.3, 0.15) *
              (0.5 + 0.5 * std::cos(2 * pi * 36 * s));
    return height;
}

double wheel_relief(double azimuth, double k) {
    const double spoke = 0.5 + 0.5 * std::cos(5 * azimuth);
    const double gap = window(spoke, -1, 0.42, 0.16) * window(k, 5.2, 7.8, 0.9);
    const double ridge = window(from_whole(5 * azimuth / (2 * pi)), -1, 0.035, 0.03);
    return -0.16 * gap + 0.012 * ridge * window(k, 4.8, 8.2, 0.6);
}

}  // namespace

TyreRows make_tyre_rows() { return {spread_rows(kTyreProfile)}; }
double tyre_knot(const TyreRows& rows, double v) { return knot_at(rows.whole, 0.5 * v); }

double tyre_letters(double s, double k) {
    const TyreBands band;
    const double x = 58 * (1 - s) - 8.5;
    const double y = kLetterHeight * (band.letters_end - k) / (band.letters_end - band.letters);
    const double word = lettering("BURNISH", x, y);
    // Three bars between one word and the next.
    const double bar = std::fabs(std::fmod(58 * (1 - s) + 4.5, 58.0) - 4.5 - 0.35 * (3.5 - y));
    const double bars = window(std::fmod(bar, 3.0), 0.7, 2.1, 0.5) * window(bar, 0.0, 4.9, 0.5) *
                        window(y, 0.5, 6.5, 0.5);
    return std::fmax(word, bars);
}

double tyre_grooves(double s, double k) {
    const TyreBands band;
    const double around = 18 * s;
    const double slant = 0.42 * (kTyreMiddle - k);
    const auto cut = [](double distance, double half) { return window(distance, -1, half, 0.24); };
    const double outer =
        cut(from_whole(around + slant), 0.06) * window(k, band.shoulder + 0.5, band.groove, 0.5);
    const double inner =
        cut(from_whole(around + slant + 0.5), 0.05) * window(k, band.groove, kTyreMiddle + 1, 0.3);
    const double ring = window(k, band.groove - 0.10, band.groove + 0.10, 0.34);
    const double middle = window(k, kTyreMiddle - 0.10, kTyreMiddle + 1, 0.34);
    return std::fmax(std::fmax(outer, inner), std::fmax(ring, middle));
}

Mesh make_tyre() {
    constexpr int kColumns = 648, kRows = 136;
    const TyreRows rows = make_tyre_rows();
    const auto surface = [&](double a, double b) {
        const double v = 1 - std::fabs(2 * b - 1), k = tyre_knot(rows, v);
        const double s = kTyreRepeats * a - std::floor(kTyreRepeats * a);
        const double on_profile = b <= 0.5 ? k : 2 * kTyreMiddle - k;
        return PatchPoint{lifted_point(kTyreProfile, on_profile, 2 * pi * a, tyre_relief(s, k)),
                          {kTyreRepeats * a, v}};
    };
    return tessellate(kColumns, kRows, surface, cell_step(kColumns, kRows));
}

Mesh make_wheel() {
    constexpr int kColumns = 160, kRows = 56;
    const auto surface = [](double a, double b) {
        const double k = b * (std::size(kWheelKnots) - 1.0), azimuth = 2 * pi * a;
        const Vec2<double> p = curve_point(kWheelKnots, k);
        return PatchPoint{around_axis(std::fmax(p.x, 0.0), p.y + wheel_relief(azimuth, k), azimuth),
                          {a, b}};
    };
    return tessellate(kColumns, kRows, surface, cell_step(kColumns, kRows));
}

}  // namespace burnish::procedural
