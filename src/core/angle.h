// Trigonometry in turns (one turn = 2 pi), for float, double and Packet. What sampling needs is
// cos(2 pi u) of a uniform u and the share of a circle that a direction lies at: in turns the range
// reduction is exact, and with polynomials a packet costs what one call of the library does. Lane
// by lane the same bits as for a float. Doubles go to the library.
#pragma once

#include "core/packet.h"
#include "core/scalar.h"

namespace burnish {

template <class T>
struct SinCos {
    T sin{}, cos{};
};

/// sin(2 pi turns) and cos(2 pi turns). Absolute error below 2e-7 for |turns| <= 1.
template <class T>
SinCos<T> sin_cos_turns(const T& turns) {
    if constexpr (std::is_same_v<T, double>) {
        const double angle = 2 * std::numbers::pi * turns;
        return {std::sin(angle), std::cos(angle)};
    } else {
        // turns = quarter / 4 + r with |r| <= 1/8; least-maximum fits over that range.
        const T quarter = floor(turns * T(4.0f) + T(0.5f));
        const T r = turns - quarter * T(0.25f), z = r * r;
        constexpr std::array<float, 4> kSin{6.28318548f, -41.3416634f, 81.5923538f, -75.3935623f};
        constexpr std::array<float, 5> kCos{1.0f, -19.7392082f, 64.9393082f, -85.4422989f,
                                            59.2027969f};
        const T s = r * polynomial(z, kSin), c = polynomial(z, kCos);
        // Which quarter of the circle, as 0, 1, 2 or 3.
        const T phase = quarter - T(4.0f) * floor(quarter * T(0.25f));
        const auto odd = phase == T(1.0f) || phase == T(3.0f);
        const auto lower = phase >= T(2.0f), left = phase == T(1.0f) || phase == T(2.0f);
        const T sine = select(odd, c, s), cosine = select(odd, s, c);
        return {select(lower, -sine, sine), select(left, -cosine, cosine)};
    }
}

/// The angle of (x, y) from the x axis in turns, in [-1/2, 1/2]; 0 for (0, 0). Relative error below
/// 4e-7.
template <class T>
T atan2_turns(const T& y, const T& x) {
    if constexpr (std::is_same_v<T, double>) {
        return std::atan2(y, x) / (2 * std::numbers::pi);
    } else {
        const T ax = abs(x), ay = abs(y);
        const T ratio = safe_divide(T(min(ax, ay)), T(max(ax, ay)));  // in [0, 1]
        constexpr std::array<float, 9> kAtan{0.159154937f,   -0.0530512333f,  0.031819243f,
                                             -0.0226058029f, 0.0169355739f,   -0.0119434558f,
                                             0.00679456582f, -0.00255740108f, 0.000453573739f};
        const T octant = ratio * polynomial(T(ratio * ratio), kAtan);
        const T quadrant = select(ay > ax, T(0.25f) - octant, octant);
        const T half = select(x < T(0.0f), T(0.5f) - quadrant, quadrant);
        return select(y < T(0.0f), -half, half);
    }
}

}  // namespace burnish
