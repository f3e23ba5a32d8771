// Packet: 16 floats that go through a formula together, on the vector extensions of GCC and Clang
// (one AVX-512 register, two AVX ones, four SSE ones; hardly an intrinsic). A comparison gives a
// Mask; select takes lanes. Every lane is always initialised: lanes beyond the data repeat a valid
// one or are 0, and their results are ignored.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <type_traits>

#if defined(__AVX512F__)
#include <immintrin.h>
#endif

#include "burnish/core/scalar.h"

namespace burnish {

inline constexpr int kLanes = 16;

/// One truth value per lane: all bits set or none.
struct Mask {
    using Lanes = std::int32_t __attribute__((vector_size(4 * kLanes)));
    Lanes v{};

    Mask() = default;
    explicit Mask(const Lanes& lanes) : v(lanes) {}
    Mask(bool all_lanes) : v(Lanes{} - (all_lanes ? 1 : 0)) {}

    friend Mask operator&&(const Mask& a, const Mask& b) { return Mask(a.v & b.v); }
    friend Mask operator||(const Mask& a, const Mask& b) { return Mask(a.v | b.v); }
    friend Mask operator!(const Mask& a) { return Mask(~a.v); }
};

inline bool get(const Mask& m, int lane) { return m.v[lane] != 0; }
inline void set(Mask& m, int lane, bool b) { m.v[lane] = b ? -1 : 0; }

inline bool any(const Mask& m) {
    std::int64_t words[kLanes / 2];
    std::memcpy(words, &m.v, sizeof words);
    std::int64_t bits = 0;
    for (const std::int64_t w : words) bits |= w;
    return bits != 0;
}
inline bool all(const Mask& m) { return !any(!m); }

struct Packet {
    using Lanes = float __attribute__((vector_size(4 * kLanes)));
    Lanes v{};

    Packet() = default;
    explicit Packet(const Lanes& lanes) : v(lanes) {}
    /// The same number in every lane.
    template <class A>
    requires std::is_arithmetic_v<A> Packet(A x) : v(Lanes{} + static_cast<float>(x)) {}

    friend Packet operator-(const Packet& a) { return Packet(-a.v); }
    friend Packet operator+(const Packet& a, const Packet& b) { return Packet(a.v + b.v); }
    friend Packet operator-(const Packet& a, const Packet& b) { return Packet(a.v - b.v); }
    friend Packet operator*(const Packet& a, const Packet& b) { return Packet(a.v * b.v); }
    friend Packet operator/(const Packet& a, const Packet& b) { return Packet(a.v / b.v); }

    friend Mask operator<(const Packet& a, const Packet& b) { return Mask(a.v < b.v); }
    friend Mask operator>(const Packet& a, const Packet& b) { return Mask(a.v > b.v); }
    friend Mask operator<=(const Packet& a, const Packet& b) { return Mask(a.v <= b.v); }
    friend Mask operator>=(const Packet& a, const Packet& b) { return Mask(a.v >= b.v); }
    friend Mask operator==(const Packet& a, const Packet& b) { return Mask(a.v == b.v); }
    friend Mask operator!=(const Packet& a, const Packet& b) { return Mask(a.v != b.v); }
};

inline float get(const Packet& p, int lane) { return p.v[lane]; }
inline void set(Packet& p, int lane, float x) { p.v[lane] = x; }

/// 16 consecutive floats, unaligned.
inline Packet load(const float* from) {
    Packet p;
    std::memcpy(&p.v, from, sizeof p.v);
    return p;
}
inline void store(float* to, const Packet& p) { std::memcpy(to, &p.v, sizeof p.v); }

inline Packet value(const Packet& p) { return p; }
inline Packet select(const Mask& m, const Packet& a, const Packet& b) {
    return Packet(m.v ? a.v : b.v);
}
inline Packet min(const Packet& a, const Packet& b) { return select(a < b, a, b); }
inline Packet max(const Packet& a, const Packet& b) { return select(a > b, a, b); }
inline Packet abs(const Packet& p) { return select(p < Packet(0.0f), -p, p); }

/// One unsigned integer per lane.
using LaneIntegers = std::uint32_t __attribute__((vector_size(4 * kLanes)));

/// Lanes in [0, 2^31), rounded down.
inline LaneIntegers to_integers(const Packet& p) {
    using Signed = std::int32_t __attribute__((vector_size(4 * kLanes)));
    return reinterpret_cast<LaneIntegers>(__builtin_convertvector(p.v, Signed));
}

/// from[index] of each lane; index below 2^31.
inline Packet gather(const float* from, const LaneIntegers& index) {
#if defined(__AVX512F__)
    return Packet(reinterpret_cast<Packet::Lanes>(_mm512_mask_i32gather_ps(
        _mm512_setzero_ps(), 0xffff, reinterpret_cast<__m512i>(index), from, sizeof(float))));
#else
    std::uint32_t at[kLanes];
    std::memcpy(at, &index, sizeof at);
    float lanes[kLanes];
    for (int i = 0; i < kLanes; ++i) lanes[i] = from[at[i]];
    return load(lanes);
#endif
}

/// from[index[lane]] of each lane.
template <class Index>
Packet gather(const float* from, const Index* index) {
    float lanes[kLanes];
    for (int i = 0; i < kLanes; ++i) lanes[i] = from[index[i]];
    return load(lanes);
}

/// Sixteen packets as a matrix of 16 x 16 floats.
using PacketBlock = std::array<Packet, kLanes>;

/// Lane i of packet j becomes lane j of packet i: sixteen records of sixteen floats become sixteen
/// packets of one field each.
inline void transpose(PacketBlock& rows) {
    // Four rounds of interleaving rows i and i + 8 take each element's index bits once around.
#if defined(__clang__)
    const auto low = [](const Packet::Lanes& a, const Packet::Lanes& b) {
        return __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7,
                                       23);
    };
    const auto high = [](const Packet::Lanes& a, const Packet::Lanes& b) {
        return __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30,
                                       15, 31);
    };
#else
    const auto low = [](const Packet::Lanes& a, const Packet::Lanes& b) {
        return __builtin_shuffle(
            a, b, Mask::Lanes{0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23});
    };
    const auto high = [](const Packet::Lanes& a, const Packet::Lanes& b) {
        return __builtin_shuffle(
            a, b, Mask::Lanes{8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31});
    };
#endif
    for (int round = 0; round < 4; ++round) {
        PacketBlock next;
        for (std::size_t i = 0; i < kLanes / 2; ++i) {
            next[2 * i] = Packet(low(rows[i].v, rows[i + kLanes / 2].v));
            next[2 * i + 1] = Packet(high(rows[i].v, rows[i + kLanes / 2].v));
        }
        rows = next;
    }
}

/// f of each lane.
template <class F>
Packet map_lanes(const Packet& p, F f) {
    float lanes[kLanes];
    store(lanes, p);
    for (float& x : lanes) x = f(x);
    return load(lanes);
}
inline Packet sqrt(const Packet& p) {
    return map_lanes(p, [](float x) { return __builtin_sqrtf(x); });
}
inline Packet floor(const Packet& p) {
    return map_lanes(p, [](float x) { return __builtin_floorf(x); });
}
inline Packet log(const Packet& p) {
    return map_lanes(p, [](float x) { return std::log(x); });
}
inline Packet exp(const Packet& p) {
    return map_lanes(p, [](float x) { return std::exp(x); });
}

}  // namespace burnish
