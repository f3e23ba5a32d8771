// Dual numbers: derivatives against central differences, values against plain arithmetic.
#include "core/dual.h"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "core/packet.h"
#include "core/random.h"
#include "core/vec.h"

namespace burnish {
namespace {

/// A formula in each scalar type.
struct Formula {
    const char* name;
    std::function<double(double, double)> plain;
    std::function<float(float, float)> single;
    std::function<Dual<double, 2>(Dual<double, 2>, Dual<double, 2>)> dual;
    std::function<Dual<float, 2>(Dual<float, 2>, Dual<float, 2>)> single_dual;
    std::function<Packet(Packet, Packet)> packet;
};

template <class F>
Formula formula(const char* name, F f) {
    return {name, f, f, f, f, f};
}

/// Constants in the plain type of T.
template <class T>
Plain<T> number(double x) {
    return static_cast<Plain<T>>(x);
}

std::vector<Formula> formulas() {
    return {
        formula("sum", [](auto a, auto b) { return a + b - a * b; }),
        formula("quotient", [](auto a, auto b) { return a / (b + a); }),
        formula("constants",
                [](auto a, auto b) {
                    using T = decltype(a);
                    const auto two = number<T>(2), half = number<T>(0.5);
                    return (two - a) * half + two * b - (a - two) / (half + b) + half / (a + half);
                }),
        formula("negation", [](auto a, auto b) { return -a * b; }),
        formula("reciprocal", [](auto a, auto b) { return reciprocal(a * b) + reciprocal(b); }),
        formula("root", [](auto a, auto b) { return sqrt(a) * safe_sqrt(b); }),
        formula("logarithm", [](auto a, auto b) { return log(a) + exp(b * a); }),
        formula("extremes", [](auto a, auto b) { return min(a, b) + max(a, b) * a + abs(a - b); }),
        formula("powers", [](auto a, auto b) { return pow5(a) * sqr(b) + lerp(a, b, a * b); }),
        formula("clamp", [](auto a, auto b) { return clamp01(a + b) + clamp01(a * b); }),
        formula("safe_divide", [](auto a, auto b) { return safe_divide(a, b); }),
        formula("mulsign",
                [](auto a, auto b) {
                    using T = decltype(a);
                    return mulsign(T(a * b), value(a) - number<T>(1));
                }),
        formula("vector",
                [](auto a, auto b) {
                    using T = decltype(a);
                    const Vec3<T> v{a, b, a * b};
                    return dot(normalize(v), cross(v, Vec3<T>{b, a, b})) + luminance(v);
                }),
    };
}

/// In (0.1, 2.1): away from the kinks at a = b by chance.
std::array<float, 2> pair(std::uint32_t i) {
    const auto u = uniforms({11, Stream::kTest}, i, 0, 0);
    return {0.1f + 2 * u[0], 0.1f + 2 * u[1]};
}

TEST(Dual, DerivativesAreCentralDifferences) {
    constexpr double kStep = 1e-6;
    for (const Formula& f : formulas()) {
        for (std::uint32_t i = 0; i < 50; ++i) {
            const double a = static_cast<double>(pair(i)[0]), b = static_cast<double>(pair(i)[1]);
            const auto d = f.dual(variable<2>(a, 0), variable<2>(b, 1));
            const double da = (f.plain(a + kStep, b) - f.plain(a - kStep, b)) / (2 * kStep);
            const double db = (f.plain(a, b + kStep) - f.plain(a, b - kStep)) / (2 * kStep);
            EXPECT_NEAR(d.d[0], da, 1e-7 * (1 + std::abs(da))) << f.name << " " << a << " " << b;
            EXPECT_NEAR(d.d[1], db, 1e-7 * (1 + std::abs(db))) << f.name << " " << a << " " << b;
        }
    }
}

TEST(Dual, ValuesHaveTheBitsOfPlainArithmetic) {
    for (const Formula& f : formulas()) {
        Packet a, b;
        for (std::uint32_t i = 0; i < 10 * kLanes; ++i) {
            const auto [x, y] = pair(i);
            const int lane = static_cast<int>(i) % kLanes;
            set(a, lane, x);
            set(b, lane, y);
            const float expected = f.single(x, y);
            EXPECT_EQ(f.single_dual(variable<2>(x, 0), variable<2>(y, 1)).v, expected) << f.name;
            EXPECT_EQ(get(f.packet(a, b), lane), expected) << f.name;
        }
    }
}

TEST(Dual, ValueDetaches) {
    const auto x = variable<2>(3.0, 0);
    const Dual<double, 2> y = value(x) * x;
    EXPECT_EQ(y.v, 9.0);
    EXPECT_EQ(y.d[0], 3.0);
}

TEST(Dual, DerivativesStayFiniteWhereTheSlopeIsNot) {
    const auto zero = variable<1>(0.0, 0);
    EXPECT_EQ(safe_sqrt(zero).v, 0.0);
    EXPECT_EQ(safe_sqrt(zero).d[0], 0.0);
    EXPECT_EQ(safe_divide(variable<1>(1.0, 0), zero).d[0], 0.0);
}

/// Packets of duals differentiate each lane.
TEST(Dual, WorksOverPackets) {
    Packet x;
    for (int i = 0; i < kLanes; ++i) set(x, i, 0.5f + static_cast<float>(i));
    const Dual<Packet, 1> d = variable<1>(x, 0);
    const Dual<Packet, 1> y = select(x < Packet(4.0f), d * d, sqrt(d) / (d + Packet(1.0f)));
    for (int i = 0; i < kLanes; ++i) {
        const Dual<float, 1> s = variable<1>(get(x, i), 0);
        const Dual<float, 1> expected = s.v < 4.0f ? s * s : sqrt(s) / (s + 1.0f);
        EXPECT_EQ(get(y.v, i), expected.v);
        EXPECT_EQ(get(y.d[0], i), expected.d[0]);
    }
}

}  // namespace
}  // namespace burnish
