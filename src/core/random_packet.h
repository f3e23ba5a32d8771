// The random numbers of core/random.h for sixteen samples at a time: the same bits, lane by lane.
#pragma once

#include "core/packet.h"
#include "core/random.h"

namespace burnish {

/// Registers of half as many lanes, twice as wide.
using DoubleWords = Register<std::uint64_t>;

/// The products of the even lanes, each as wide as two. (Compilers multiply all 64 bits.)
inline DoubleWords even_products(const DoubleWords& a, const DoubleWords& b) {
#if defined(__AVX512F__)
    return reinterpret_cast<DoubleWords>(
        _mm512_maskz_mul_epu32(0xff, reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b)));
#elif defined(__AVX2__)
    return reinterpret_cast<DoubleWords>(
        _mm256_mul_epu32(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
#elif defined(__SSE2__) && !defined(__AVX__)
    return reinterpret_cast<DoubleWords>(
        _mm_mul_epu32(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#else
    constexpr std::uint64_t kLow = 0xffffffff;
    return (a & kLow) * (b & kLow);
#endif
}

/// The products of all lanes.
inline WideProduct<LaneIntegers> wide_product(const LaneIntegers& a, std::uint32_t b) {
    using Words = Register<std::uint32_t>;
    WideProduct<LaneIntegers> product;
    for (std::size_t i = 0; i < kRegisters; ++i) {
        const auto words = reinterpret_cast<DoubleWords>(a.r[i]);
        const DoubleWords factor = DoubleWords{} + b;
        const auto even = reinterpret_cast<Words>(even_products(words, factor));
        const auto odd = reinterpret_cast<Words>(even_products(words >> 32, factor));
        product.low.r[i] = lanes_with_bit<1, false>(even, odd);
        product.high.r[i] = lanes_with_bit<1, true>(even, odd);
    }
    return product;
}

/// philox4x32 of sixteen counters under one key.
inline std::array<LaneIntegers, 4> philox4x32(const std::array<LaneIntegers, 4>& counter,
                                              const std::array<std::uint32_t, 2>& key) {
    return philox_rounds(counter, key, [](std::uint32_t constant, const LaneIntegers& word) {
        return wide_product(word, constant);
    });
}

inline Packet to_unit_float(const LaneIntegers& bits) {
    return to_floats(bits >> 8) * Packet(0x1p-24f);
}

/// uniforms of sixteen counters.
inline std::array<Packet, 4> uniforms(RandomKey key, const LaneIntegers& sample,
                                      const LaneIntegers& iteration, const LaneIntegers& block,
                                      std::uint32_t bounce = 0) {
    const auto bits = philox4x32({sample, iteration, block, LaneIntegers{} + bounce},
                                 {key.seed, static_cast<std::uint32_t>(key.stream)});
    return {to_unit_float(bits[0]), to_unit_float(bits[1]), to_unit_float(bits[2]),
            to_unit_float(bits[3])};
}

}  // namespace burnish
