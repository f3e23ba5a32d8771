// Dual numbers: a value together with its derivatives to N inputs, carried forward through a
// formula.
//
// A dual number v + sum_k d_k e_k obeys ordinary algebra with e_k e_l = 0. A function f then
// satisfies f(v + sum d_k e_k) = f(v) + f'(v) sum d_k e_k: evaluating a formula once with duals
// gives its value and, by the chain rule, its exact derivatives. Input k of N starts as
// variable<N>(v, k) with d_k = 1; constants and detached quantities are plain S and carry no
// derivative. The value is computed by the same operations in the same order as without
// derivatives, so it has the same bits.
//
// S is float, double or Packet. Comparisons look at the value alone. Only what the leaf maths needs
// is here.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "core/scalar.h"

namespace burnish {

template <class S, int N>
struct Dual {
    S v{};                                           ///< the value
    std::array<S, static_cast<std::size_t>(N)> d{};  ///< the derivative to each input

    Dual() = default;
    Dual(const S& constant) : v(constant) {}
    template <class A>
    requires std::is_arithmetic_v<A>
    explicit Dual(A constant) : v(static_cast<S>(constant)) {}

    /// The result of a unary function: value f and slope f' at x.
    static Dual chain(const S& f, const S& slope, const Dual& x) {
        Dual r(f);
        for (std::size_t k = 0; k < N; ++k) r.d[k] = slope * x.d[k];
        return r;
    }

    friend Dual operator-(const Dual& a) { return chain(-a.v, S(-1.0f), a); }

    friend Dual operator+(const Dual& a, const Dual& b) {
        Dual r(a.v + b.v);
        for (std::size_t k = 0; k < N; ++k) r.d[k] = a.d[k] + b.d[k];
        return r;
    }
    friend Dual operator-(const Dual& a, const Dual& b) {
        Dual r(a.v - b.v);
        for (std::size_t k = 0; k < N; ++k) r.d[k] = a.d[k] - b.d[k];
        return r;
    }
    friend Dual operator*(const Dual& a, const Dual& b) {
        Dual r(a.v * b.v);
        for (std::size_t k = 0; k < N; ++k) r.d[k] = a.v * b.d[k] + a.d[k] * b.v;
        return r;
    }
    friend Dual operator/(const Dual& a, const Dual& b) {
        Dual r(a.v / b.v);
        const S inverse = S(1.0f) / b.v;
        for (std::size_t k = 0; k < N; ++k) r.d[k] = (a.d[k] - r.v * b.d[k]) * inverse;
        return r;
    }

    // With a constant: the derivative of the constant is not multiplied through.
    friend Dual operator+(const Dual& a, const S& b) { return with_value(a, a.v + b); }
    friend Dual operator+(const S& a, const Dual& b) { return with_value(b, a + b.v); }
    friend Dual operator-(const Dual& a, const S& b) { return with_value(a, a.v - b); }
    friend Dual operator-(const S& a, const Dual& b) { return chain(a - b.v, S(-1.0f), b); }
    friend Dual operator*(const Dual& a, const S& b) { return chain(a.v * b, b, a); }
    friend Dual operator*(const S& a, const Dual& b) { return chain(a * b.v, a, b); }
    friend Dual operator/(const Dual& a, const S& b) { return chain(a.v / b, S(1.0f) / b, a); }
    friend Dual operator/(const S& a, const Dual& b) {
        const S quotient = a / b.v;
        return chain(quotient, -quotient / b.v, b);
    }

    friend auto operator<(const Dual& a, const Dual& b) { return a.v < b.v; }
    friend auto operator>(const Dual& a, const Dual& b) { return a.v > b.v; }
    friend auto operator<=(const Dual& a, const Dual& b) { return a.v <= b.v; }
    friend auto operator>=(const Dual& a, const Dual& b) { return a.v >= b.v; }
    friend auto operator==(const Dual& a, const Dual& b) { return a.v == b.v; }

    friend S value(const Dual& x) { return x.v; }

    template <class M>
    friend Dual select(const M& condition, const Dual& a, const Dual& b) {
        Dual r(select(condition, a.v, b.v));
        for (std::size_t k = 0; k < N; ++k) r.d[k] = select(condition, a.d[k], b.d[k]);
        return r;
    }
    friend Dual min(const Dual& a, const Dual& b) { return select(a.v < b.v, a, b); }
    friend Dual max(const Dual& a, const Dual& b) { return select(a.v > b.v, a, b); }
    friend Dual abs(const Dual& x) { return select(x.v < S(0.0f), -x, x); }

    friend Dual reciprocal(const Dual& x) {
        const S r = S(1.0f) / x.v;
        return chain(r, -(r * r), x);
    }
    friend Dual sqrt(const Dual& x) {
        const S root = sqrt(x.v);
        return chain(root, S(0.5f) / root, x);
    }
    friend Dual log(const Dual& x) { return chain(log(x.v), S(1.0f) / x.v, x); }
    friend Dual exp(const Dual& x) {
        const S e = exp(x.v);
        return chain(e, e, x);
    }

  private:
    static Dual with_value(const Dual& x, const S& v) {
        Dual r = x;
        r.v = v;
        return r;
    }
};

/// Input k of N: value v, derivative 1 to itself.
template <int N, class S>
Dual<S, N> variable(const S& v, int k) {
    Dual<S, N> x(v);
    x.d[static_cast<std::size_t>(k)] = S(1.0f);
    return x;
}

/// All inputs.
template <class S, std::size_t N>
std::array<Dual<S, static_cast<int>(N)>, N> variables(const std::array<S, N>& values) {
    std::array<Dual<S, static_cast<int>(N)>, N> all;
    for (std::size_t k = 0; k < N; ++k)
        all[k] = variable<static_cast<int>(N)>(values[k], static_cast<int>(k));
    return all;
}

}  // namespace burnish
