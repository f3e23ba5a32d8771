// Reconstruction filters h(x), one axis, not normalised, with Mitsuba's values.
//
// The Gaussian is the one that Mitsuba's vectorised variants evaluate: a polynomial p of degree 9
// in (x / stddev)^2 that differs from exp(-x^2 / (2 stddev^2)) by up to 4e-4, less its value at the
// cut-off so that it ends in 0. The coefficients here were fitted to weights that Mitsuba computed;
// 6e-6 is left, the noise of its single precision.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "scene/camera.h"

namespace burnish {

/// The radius of the widest filter, in pixels.
inline constexpr float kMaxFilterRadius = 7.5f;
/// Of Lanczos' filter, whose radius they are.
inline constexpr int kMaxLobes = 7;

/// Without the constant term, which cancels.
inline double gaussian_polynomial(double t2) {
    constexpr std::array<double, 9> kCoefficients{
        -0.4977052882162227,    0.1222305298231228,      -0.01932837198544746,
        0.0021383159050523,     -0.00016831649853540556, 9.241255490647771e-06,
        -3.356145947797515e-07, 7.225718966795516e-09,   -6.967327214109122e-11};
    double sum = 0;
    for (std::size_t k = kCoefficients.size(); k-- > 0;) sum = (sum + kCoefficients[k]) * t2;
    return sum;
}

/// Mitchell and Netravali (1988), support [-2, 2].
inline double mitchell_filter(double x, double b, double c) {
    const double x2 = x * x, x3 = x2 * x;
    if (x < 1) return ((12 - 9 * b - 6 * c) * x3 + (-18 + 12 * b + 6 * c) * x2 + (6 - 2 * b)) / 6;
    return ((-b - 6 * c) * x3 + (6 * b + 30 * c) * x2 + (-12 * b - 48 * c) * x + (8 * b + 24 * c)) /
           6;
}

/// h(x) for x in pixels, in double.
inline double eval_filter_exact(const ReconstructionFilter& f, double x) {
    x = std::abs(x);
    const double radius = f.radius;
    if (!(x <= radius)) return 0;
    switch (f.kind) {
        case FilterKind::kBox:
            return 1;
        case FilterKind::kTent:
            return 1 - x / radius;
        case FilterKind::kGaussian: {
            const double t = x / f.stddev, end = radius / f.stddev;
            return std::max(0.0, gaussian_polynomial(t * t) - gaussian_polynomial(end * end));
        }
        case FilterKind::kMitchell:
            return x < 2 ? mitchell_filter(x, f.b, f.c) : 0;
        case FilterKind::kCatmullRom:
            return x < 2 ? mitchell_filter(x, 0, 0.5) : 0;
        case FilterKind::kLanczos: {
            const double a = std::numbers::pi * x;
            return a < 1e-6 ? 1 : std::sin(a) * std::sin(a / radius) / (a * a / radius);
        }
    }
    return 0;
}

inline float eval_filter(const ReconstructionFilter& f, float x) {
    return static_cast<float>(eval_filter_exact(f, x));
}

/// The integral of h over [a, b], a <= b, to 1e-9 of that of |h| over its support. Gauss-Legendre
/// on pieces between which h is smooth.
inline double filter_integral_exact(const ReconstructionFilter& f, double a, double b) {
    constexpr std::array<double, 4> kNode{0.1834346424956498, 0.5255324099163290,
                                          0.7966664774136267, 0.9602898564975363};
    constexpr std::array<double, 4> kWeight{0.3626837833783620, 0.3137066458778873,
                                            0.2223810344533745, 0.1012285362903763};
    constexpr int kPieces = 16;  // even, and a multiple of 4: knots at 0 and, for radius 2, at 1
    double sum = 0;
    for (int i = 0; i < kPieces; ++i) {
        const double width = 2.0 * static_cast<double>(f.radius) / kPieces;
        const double low = std::max(a, width * i - static_cast<double>(f.radius));
        const double high = std::min(b, width * (i + 1) - static_cast<double>(f.radius));
        if (!(high > low)) continue;
        const double center = 0.5 * (low + high), half = 0.5 * (high - low);
        for (std::size_t k = 0; k < kNode.size(); ++k)
            sum += half * kWeight[k] *
                   (eval_filter_exact(f, center - half * kNode[k]) +
                    eval_filter_exact(f, center + half * kNode[k]));
    }
    return sum;
}

inline float filter_integral(const ReconstructionFilter& f, float a, float b) {
    return static_cast<float>(filter_integral_exact(f, a, b));
}

}  // namespace burnish
