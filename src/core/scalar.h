// The vocabulary of the leaf maths: what a scalar type T must offer. T is float or double here,
// Dual<S, N> in dual.h and Packet in packet.h. Code written in these words gives the bit-identical
// primal result for a float, for the value of a Dual<float, N> and for each lane of a Packet.
//
// Branch by select(mask, a, b), which evaluates both sides: guard what is unsafe *inside* them too.
// value(x) detaches: it drops the derivatives.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace burnish {

using std::abs;
using std::erf;
using std::exp;
using std::floor;
using std::log;
using std::sqrt;

inline float value(float x) { return x; }
inline double value(double x) { return x; }

inline float select(bool condition, float a, float b) { return condition ? a : b; }
inline double select(bool condition, double a, double b) { return condition ? a : b; }

/// A comparison with NaN is false: min and max then return b.
inline float min(float a, float b) { return a < b ? a : b; }
inline double min(double a, double b) { return a < b ? a : b; }
inline float max(float a, float b) { return a > b ? a : b; }
inline double max(double a, double b) { return a > b ? a : b; }

inline bool any(bool mask) { return mask; }
inline bool all(bool mask) { return mask; }

/// T without derivatives: float for float and Dual<float, N>, Packet for Packet and Dual<Packet,
/// N>.
template <class T>
using Plain = std::remove_cvref_t<decltype(value(std::declval<const T&>()))>;

/// What a comparison of two T gives: bool, or one bool per lane. Combine with && || !, which do not
/// short-circuit for lanes.
template <class T>
using MaskOf = decltype(std::declval<const Plain<T>&>() < std::declval<const Plain<T>&>());

/// What expressions of several scalar types over one plain type have: that with derivatives, if
/// any.
template <class... Ts>
using Joint = decltype((std::declval<const Ts&>() * ...));

template <class T>
T sqr(const T& x) {
    return x * x;
}
template <class T>
T pow5(const T& x) {
    return sqr(sqr(x)) * x;
}
template <class T>
T lerp(const T& a, const T& b, const T& t) {
    return a + (b - a) * t;
}
template <class T>
T clamp01(const T& x) {
    return min(max(x, T(0.0f)), T(1.0f));
}

/// 1 / x. Of a dual number it takes one division; a quotient takes two.
template <class T>
T reciprocal(const T& x) {
    return Plain<T>(1.0f) / x;
}

/// The root of a number that rounding may have pushed below 0: 0 there, with derivative 0.
template <class T>
T safe_sqrt(const T& x) {
    const auto positive = value(x) > Plain<T>(0.0f);
    return select(positive, sqrt(select(positive, x, T(1.0f))), T(0.0f));
}

/// numerator / denominator; 0 (with derivative 0) where the denominator is 0.
template <class T>
T safe_divide(const T& numerator, const T& denominator) {
    const auto zero = value(denominator) == Plain<T>(0.0f);
    return select(zero, T(0.0f), numerator / select(zero, T(1.0f), denominator));
}

/// c[0] + c[1] x + c[2] x^2 ...
template <class T, std::size_t N>
T polynomial(const T& x, const std::array<float, N>& c) {
    T sum(c[N - 1]);
    for (std::size_t k = N - 1; k-- > 0;) sum = sum * x + T(c[k]);
    return sum;
}

/// x with erf(x) = y, -1 < y < 1, to 1e-6 of it [Giles 2010].
template <class U>
U inverse_erf(const U& y) {
    constexpr std::array<float, 9> kMiddle{1.50140941f,     0.246640727f,    -0.00417768164f,
                                           -0.00125372503f, 0.00021858087f,  -4.39150654e-06f,
                                           -3.5233877e-06f, 3.43273939e-07f, 2.81022636e-08f};
    constexpr std::array<float, 9> kTails{2.83297682f,    1.00167406f,     0.00943887047f,
                                          -0.0076224613f, 0.00573950773f,  -0.00367342844f,
                                          0.00134934322f, 0.000100950558f, -0.000200214257f};
    const U w = -log((U(1.0f) - y) * (U(1.0f) + y));
    const U middle = polynomial(w - U(2.5f), kMiddle);
    const U tails = polynomial(sqrt(max(w, U(0.0f))) - U(3.0f), kTails);
    return y * select(w < U(5.0f), middle, tails);
}

/// magnitude, negated where sign_source < 0.
template <class T>
T mulsign(const T& magnitude, const Plain<T>& sign_source) {
    return select(sign_source < Plain<T>(0.0f), -magnitude, magnitude);
}

}  // namespace burnish
