// Small vectors over a scalar type T: float, Dual<float, N> or Packet. Used for points, directions
// (away from the surface) and linear RGB alike.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "core/scalar.h"

namespace burnish {

template <class T>
struct Vec2 {
    T x{}, y{};
};

template <class T>
struct Vec3 {
    T x{}, y{}, z{};

    T& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
    const T& operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
};

template <class T>
using Rgb = Vec3<T>;  ///< linear RGB, Rec. 709 primaries

using Vec2f = Vec2<float>;
using Vec3f = Vec3<float>;
using Rgbf = Rgb<float>;

inline Vec3<double> to_double(const Vec3f& v) { return {v.x, v.y, v.z}; }
inline Vec3f to_float(const Vec3<double>& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

template <class T>
Vec2<T> operator+(const Vec2<T>& a, const Vec2<T>& b) {
    return {a.x + b.x, a.y + b.y};
}
template <class T>
Vec2<T> operator-(const Vec2<T>& a, const Vec2<T>& b) {
    return {a.x - b.x, a.y - b.y};
}
template <class T>
Vec2<T> operator*(const Vec2<T>& a, const T& s) {
    return {a.x * s, a.y * s};
}

template <class T>
Vec3<T> operator+(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
Vec3<T> operator-(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
Vec3<T> operator*(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
template <class T>
Vec3<T> operator-(const Vec3<T>& a) {
    return {-a.x, -a.y, -a.z};
}
template <class T>
Vec3<T> operator*(const Vec3<T>& a, const T& s) {
    return {a.x * s, a.y * s, a.z * s};
}
template <class T>
Vec3<T> operator*(const T& s, const Vec3<T>& a) {
    return a * s;
}
template <class T>
Vec3<T> operator/(const Vec3<T>& a, const T& s) {
    return a * (T(1) / s);
}
template <class T>
Vec3<T>& operator+=(Vec3<T>& a, const Vec3<T>& b) {
    return a = a + b;
}
template <class T>
Vec3<T>& operator*=(Vec3<T>& a, const T& s) {
    return a = a * s;
}
template <class T>
bool operator==(const Vec2<T>& a, const Vec2<T>& b) {
    return a.x == b.x && a.y == b.y;
}
template <class T>
bool operator==(const Vec3<T>& a, const Vec3<T>& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

template <class T>
T dot(const Vec3<T>& a, const Vec3<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
T length_squared(const Vec3<T>& a) {
    return dot(a, a);
}
template <class T>
T length(const Vec3<T>& a) {
    return sqrt(dot(a, a));
}
template <class T>
Vec3<T> normalize(const Vec3<T>& a) {
    return a / length(a);
}

template <class M, class T>
Vec3<T> select(const M& mask, const Vec3<T>& a, const Vec3<T>& b) {
    return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

/// Mitsuba's.
inline constexpr std::array<float, 3> kLuminanceWeights{0.212671f, 0.715160f, 0.072169f};
/// Luminance of linear RGB.
template <class T>
T luminance(const Rgb<T>& c) {
    return T(kLuminanceWeights[0]) * c.x + T(kLuminanceWeights[1]) * c.y +
           T(kLuminanceWeights[2]) * c.z;
}
/// That of a gray colour is the gray, to the bit.
template <class T>
T mean(const Rgb<T>& c) {
    return c.x + ((c.y - c.x) + (c.z - c.x)) / T(3.0f);
}
/// g times the derivative of the luminance by each channel.
template <class T>
Rgb<T> luminance_derivative(const T& g) {
    return {T(kLuminanceWeights[0]) * g, T(kLuminanceWeights[1]) * g, T(kLuminanceWeights[2]) * g};
}
inline float max_component(const Vec3f& a) { return std::fmax(a.x, std::fmax(a.y, a.z)); }
inline bool is_finite(const Vec3f& a) {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
inline bool is_black(const Rgbf& c) { return c.x == 0 && c.y == 0 && c.z == 0; }

}  // namespace burnish
