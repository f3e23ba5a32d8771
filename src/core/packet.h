// Packet: 16 floats that go through a formula together, on the vector extensions of GCC and Clang:
// one AVX-512 register, two AVX ones, four SSE or NEON ones. (Hardly an intrinsic; and not one
// vector of 16 where registers are shorter, which GCC compares and selects one lane at a time and
// keeps in memory.) A comparison gives a Mask; select takes lanes. Every lane is always
// initialised: lanes beyond the data repeat a valid one or are 0, and their results are ignored.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <type_traits>

#if defined(__AVX512F__)
#include <immintrin.h>
#endif

#include "core/scalar.h"

namespace burnish {

inline constexpr int kLanes = 16;

#if defined(__AVX512F__)
inline constexpr int kRegisterLanes = 16;
#elif defined(__AVX__)
inline constexpr int kRegisterLanes = 8;
#else
inline constexpr int kRegisterLanes = 4;
#endif
inline constexpr std::size_t kRegisters = kLanes / kRegisterLanes;

template <class T>
using Register __attribute__((vector_size(4 * kRegisterLanes))) = T;
/// All lanes in one vector.
template <class T>
using Wide __attribute__((vector_size(4 * kLanes))) = T;

/// To{f(0), f(1), ...}, without a loop: compilers take these apart before they unroll loops.
template <class To, class F>
To per_register(const F& f) {
    To to;
    to.r[0] = f(0);
    if constexpr (kRegisters > 1) to.r[1] = f(1);
    if constexpr (kRegisters > 2) to.r[2] = f(2), to.r[3] = f(3);
    return to;
}

/// One truth value per lane: all bits set or none.
struct Mask {
    std::array<Register<std::int32_t>, kRegisters> r{};

    Mask() = default;
    explicit Mask(const Wide<std::int32_t>& lanes) { std::memcpy(&r, &lanes, sizeof r); }
    Mask(bool all_lanes) { r.fill(Register<std::int32_t>{} - (all_lanes ? 1 : 0)); }

    friend Mask operator&&(const Mask& a, const Mask& b) {
        return per_register<Mask>([&](std::size_t i) { return a.r[i] & b.r[i]; });
    }
    friend Mask operator||(const Mask& a, const Mask& b) {
        return per_register<Mask>([&](std::size_t i) { return a.r[i] | b.r[i]; });
    }
    friend Mask operator!(const Mask& a) {
        return per_register<Mask>([&](std::size_t i) { return ~a.r[i]; });
    }
};

inline bool get(const Mask& m, int lane) {
    return m.r[static_cast<std::size_t>(lane / kRegisterLanes)][lane % kRegisterLanes] != 0;
}
inline void set(Mask& m, int lane, bool b) {
    m.r[static_cast<std::size_t>(lane / kRegisterLanes)][lane % kRegisterLanes] = b ? -1 : 0;
}

inline bool any(const Mask& m) {
    std::int64_t words[kLanes / 2];
    std::memcpy(words, &m.r, sizeof words);
    std::int64_t bits = 0;
    for (const std::int64_t w : words) bits |= w;
    return bits != 0;
}
inline bool all(const Mask& m) { return !any(!m); }

struct Packet {
    std::array<Register<float>, kRegisters> r{};

    Packet() = default;
    explicit Packet(const Wide<float>& lanes) { std::memcpy(&r, &lanes, sizeof r); }
    /// The same number in every lane.
    template <class A>
    requires std::is_arithmetic_v<A> Packet(A x) {
        *this = per_register<Packet>(
            [&](std::size_t) { return Register<float>{} + static_cast<float>(x); });
    }

    friend Packet operator-(const Packet& a) {
        return per_register<Packet>([&](std::size_t i) { return -a.r[i]; });
    }
    friend Packet operator+(const Packet& a, const Packet& b) {
        return per_register<Packet>([&](std::size_t i) { return a.r[i] + b.r[i]; });
    }
    friend Packet operator-(const Packet& a, const Packet& b) {
        return per_register<Packet>([&](std::size_t i) { return a.r[i] - b.r[i]; });
    }
    friend Packet operator*(const Packet& a, const Packet& b) {
        return per_register<Packet>([&](std::size_t i) { return a.r[i] * b.r[i]; });
    }
    friend Packet operator/(const Packet& a, const Packet& b) {
        return per_register<Packet>([&](std::size_t i) { return a.r[i] / b.r[i]; });
    }

    friend Mask operator<(const Packet& a, const Packet& b) {
        return per_register<Mask>([&](std::size_t i) { return a.r[i] < b.r[i]; });
    }
    friend Mask operator>(const Packet& a, const Packet& b) {
        return per_register<Mask>([&](std::size_t i) { return a.r[i] > b.r[i]; });
    }
    friend Mask operator<=(const Packet& a, const Packet& b) {
        return per_register<Mask>([&](std::size_t i) { return a.r[i] <= b.r[i]; });
    }
    friend Mask operator>=(const Packet& a, const Packet& b) {
        return per_register<Mask>([&](std::size_t i) { return a.r[i] >= b.r[i]; });
    }
    friend Mask operator==(const Packet& a, const Packet& b) {
        return per_register<Mask>([&](std::size_t i) { return a.r[i] == b.r[i]; });
    }
    friend Mask operator!=(const Packet& a, const Packet& b) {
        return per_register<Mask>([&](std::size_t i) { return a.r[i] != b.r[i]; });
    }
};

inline float get(const Packet& p, int lane) {
    return p.r[static_cast<std::size_t>(lane / kRegisterLanes)][lane % kRegisterLanes];
}
inline void set(Packet& p, int lane, float x) {
    p.r[static_cast<std::size_t>(lane / kRegisterLanes)][lane % kRegisterLanes] = x;
}

/// 16 consecutive floats, unaligned.
inline Packet load(const float* from) {
    return per_register<Packet>([&](std::size_t i) {
        Register<float> r;
        std::memcpy(&r, from + i * kRegisterLanes, sizeof r);
        return r;
    });
}
inline void store(float* to, const Packet& p) { std::memcpy(to, &p.r, sizeof p.r); }

inline Packet value(const Packet& p) { return p; }
inline Packet select(const Mask& m, const Packet& a, const Packet& b) {
    return per_register<Packet>([&](std::size_t i) { return m.r[i] ? a.r[i] : b.r[i]; });
}
inline Packet min(const Packet& a, const Packet& b) { return select(a < b, a, b); }
inline Packet max(const Packet& a, const Packet& b) { return select(a > b, a, b); }
inline Packet abs(const Packet& p) {
    return per_register<Packet>([&](std::size_t i) {  // all bits but the sign
        return reinterpret_cast<Register<float>>(reinterpret_cast<Register<std::int32_t>>(p.r[i]) &
                                                 0x7fffffff);
    });
}

/// One unsigned integer per lane.
using LaneIntegers = Wide<std::uint32_t>;

/// The lanes' bits, as signed numbers.
inline Wide<std::int32_t> bits_of(const Packet& p) {
    Wide<std::int32_t> bits;
    std::memcpy(&bits, &p.r, sizeof bits);
    return bits;
}

/// Numbers below 2^31.
inline Packet to_floats(const LaneIntegers& n) {
    return per_register<Packet>([&](std::size_t i) {
        Register<std::int32_t> r;
        std::memcpy(&r, reinterpret_cast<const char*>(&n) + i * sizeof r, sizeof r);
        return __builtin_convertvector(r, Register<float>);
    });
}

/// Lanes in [0, 2^31), rounded down.
inline LaneIntegers to_integers(const Packet& p) {
    const Mask integers = per_register<Mask>(
        [&](std::size_t i) { return __builtin_convertvector(p.r[i], Register<std::int32_t>); });
    LaneIntegers n;
    std::memcpy(&n, &integers.r, sizeof n);
    return n;
}

/// from[index] of each lane; index below 2^31.
inline Packet gather(const float* from, const LaneIntegers& index) {
#if defined(__AVX512F__)
    return Packet(reinterpret_cast<Wide<float>>(_mm512_mask_i32gather_ps(
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
    const auto low = [](const Wide<float>& a, const Wide<float>& b) {
        return __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7,
                                       23);
    };
    const auto high = [](const Wide<float>& a, const Wide<float>& b) {
        return __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30,
                                       15, 31);
    };
#else
    const auto low = [](const Wide<float>& a, const Wide<float>& b) {
        return __builtin_shuffle(
            a, b, Wide<std::int32_t>{0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23});
    };
    const auto high = [](const Wide<float>& a, const Wide<float>& b) {
        return __builtin_shuffle(
            a, b, Wide<std::int32_t>{8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31});
    };
#endif
    const auto lanes_of = [](const Packet& p) {
        Wide<float> lanes;
        std::memcpy(&lanes, &p.r, sizeof lanes);
        return lanes;
    };
    for (int round = 0; round < 4; ++round) {
        PacketBlock next;
        for (std::size_t i = 0; i < kLanes / 2; ++i) {
            next[2 * i] = Packet(low(lanes_of(rows[i]), lanes_of(rows[i + kLanes / 2])));
            next[2 * i + 1] = Packet(high(lanes_of(rows[i]), lanes_of(rows[i + kLanes / 2])));
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
inline Packet erf(const Packet& p) {
    return map_lanes(p, [](float x) { return std::erf(x); });
}

}  // namespace burnish
