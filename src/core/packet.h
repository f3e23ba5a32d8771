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
#include <utility>

#if defined(__SSE2__)
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
struct LaneIntegers {
    std::array<Register<std::uint32_t>, kRegisters> r{};

    LaneIntegers() = default;
    /// The same number in every lane.
    LaneIntegers(std::uint32_t n) { r.fill(Register<std::uint32_t>{} + n); }

    friend LaneIntegers operator+(const LaneIntegers& a, const LaneIntegers& b) {
        return per_register<LaneIntegers>([&](std::size_t i) { return a.r[i] + b.r[i]; });
    }
    friend LaneIntegers operator-(const LaneIntegers& a, const LaneIntegers& b) {
        return per_register<LaneIntegers>([&](std::size_t i) { return a.r[i] - b.r[i]; });
    }
    friend LaneIntegers operator*(const LaneIntegers& a, const LaneIntegers& b) {
        return per_register<LaneIntegers>([&](std::size_t i) { return a.r[i] * b.r[i]; });
    }
    friend LaneIntegers operator/(const LaneIntegers& a, const LaneIntegers& b) {
        return per_register<LaneIntegers>([&](std::size_t i) { return a.r[i] / b.r[i]; });
    }
    friend LaneIntegers operator%(const LaneIntegers& a, const LaneIntegers& b) {
        return per_register<LaneIntegers>([&](std::size_t i) { return a.r[i] % b.r[i]; });
    }
    friend LaneIntegers operator&(const LaneIntegers& a, const LaneIntegers& b) {
        return per_register<LaneIntegers>([&](std::size_t i) { return a.r[i] & b.r[i]; });
    }
    friend LaneIntegers operator|(const LaneIntegers& a, const LaneIntegers& b) {
        return per_register<LaneIntegers>([&](std::size_t i) { return a.r[i] | b.r[i]; });
    }
    friend LaneIntegers operator^(const LaneIntegers& a, const LaneIntegers& b) {
        return per_register<LaneIntegers>([&](std::size_t i) { return a.r[i] ^ b.r[i]; });
    }
    friend LaneIntegers operator<<(const LaneIntegers& a, std::uint32_t bits) {
        return per_register<LaneIntegers>([&](std::size_t i) { return a.r[i] << bits; });
    }
    friend LaneIntegers operator>>(const LaneIntegers& a, std::uint32_t bits) {
        return per_register<LaneIntegers>([&](std::size_t i) { return a.r[i] >> bits; });
    }
    LaneIntegers& operator+=(const LaneIntegers& b) { return *this = *this + b; }
    LaneIntegers& operator^=(const LaneIntegers& b) { return *this = *this ^ b; }

    friend Mask operator==(const LaneIntegers& a, const LaneIntegers& b) {
        return per_register<Mask>([&](std::size_t i) { return a.r[i] == b.r[i]; });
    }
};

inline std::uint32_t get(const LaneIntegers& n, int lane) {
    return n.r[static_cast<std::size_t>(lane / kRegisterLanes)][lane % kRegisterLanes];
}
inline void set(LaneIntegers& n, int lane, std::uint32_t x) {
    n.r[static_cast<std::size_t>(lane / kRegisterLanes)][lane % kRegisterLanes] = x;
}

/// 16 consecutive integers, unaligned.
inline LaneIntegers load(const std::uint32_t* from) {
    LaneIntegers n;
    std::memcpy(&n.r, from, sizeof n.r);
    return n;
}
inline void store(std::uint32_t* to, const LaneIntegers& n) { std::memcpy(to, &n.r, sizeof n.r); }

/// Numbers below 2^31.
inline Packet to_floats(const LaneIntegers& n) {
    return per_register<Packet>([&](std::size_t i) {
        return __builtin_convertvector(reinterpret_cast<Register<std::int32_t>>(n.r[i]),
                                       Register<float>);
    });
}

/// Lanes in [0, 2^31), rounded down.
inline LaneIntegers to_integers(const Packet& p) {
    return per_register<LaneIntegers>([&](std::size_t i) {
        return reinterpret_cast<Register<std::uint32_t>>(
            __builtin_convertvector(p.r[i], Register<std::int32_t>));
    });
}

/// from[index[lane]] of each lane.
template <class Index>
Packet gather(const float* from, const Index* index) {
    float lanes[kLanes];
    for (int i = 0; i < kLanes; ++i) lanes[i] = from[index[i]];
    return load(lanes);
}

/// from[index] of each lane; index below 2^31.
inline Packet gather(const float* from, const LaneIntegers& index) {
#if defined(__AVX512F__)
    Packet p;
    p.r[0] = reinterpret_cast<Register<float>>(_mm512_mask_i32gather_ps(
        _mm512_setzero_ps(), 0xffff, reinterpret_cast<__m512i>(index.r[0]), from, sizeof(float)));
    return p;
#else
    std::uint32_t at[kLanes];
    store(at, index);
    return gather(from, at);
#endif
}

/// Of registers a and b the lanes whose number has a bit clear, or set; those of b take the lanes
/// whose number has it set.
template <int kBit, bool kSet, class Lanes, int... L>
Lanes lanes_with_bit(const Lanes& a, const Lanes& b, std::integer_sequence<int, L...>) {
    constexpr auto source = [](int l) {
        return (l & kBit ? kRegisterLanes : 0) + (kSet ? l | kBit : l & ~kBit);
    };
#if defined(__clang__)
    return __builtin_shufflevector(a, b, source(L)...);
#else
    return __builtin_shuffle(a, b, Register<std::int32_t>{source(L)...});
#endif
}
template <int kBit, bool kSet, class Lanes>
Lanes lanes_with_bit(const Lanes& a, const Lanes& b) {
    return lanes_with_bit<kBit, kSet>(a, b, std::make_integer_sequence<int, kRegisterLanes>());
}

/// As many registers as one has lanes.
using RegisterBlock = std::array<Register<float>, kRegisterLanes>;

/// Swaps a bit of the numbers of rows with that of lanes.
template <int kBit>
void swap_bit(RegisterBlock& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (i & kBit) continue;
        const Register<float> a = rows[i], b = rows[i | kBit];
        rows[i] = lanes_with_bit<kBit, false>(a, b);
        rows[i | kBit] = lanes_with_bit<kBit, true>(a, b);
    }
}

inline void transpose(RegisterBlock& rows) {
    swap_bit<1>(rows), swap_bit<2>(rows);
    if constexpr (kRegisterLanes > 4) swap_bit<4>(rows);
    if constexpr (kRegisterLanes > 8) swap_bit<8>(rows);
}

/// Sixteen packets as a matrix of 16 x 16 floats.
using PacketBlock = std::array<Packet, kLanes>;

/// Lane i of packet j becomes lane j of packet i: sixteen records of sixteen floats become sixteen
/// packets of one field each.
inline void transpose(PacketBlock& rows) {
    const auto take = [&](std::size_t part, std::size_t column) {
        RegisterBlock block;
        for (std::size_t i = 0; i < block.size(); ++i)
            block[i] = rows[part * block.size() + i].r[column];
        transpose(block);
        return block;
    };
    const auto put = [&](const RegisterBlock& block, std::size_t part, std::size_t column) {
        for (std::size_t i = 0; i < block.size(); ++i)
            rows[part * block.size() + i].r[column] = block[i];
    };
    for (std::size_t a = 0; a < kRegisters; ++a)
        for (std::size_t b = a; b < kRegisters; ++b) {
            const RegisterBlock upper = take(a, b), lower = take(b, a);
            put(upper, b, a), put(lower, a, b);
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
