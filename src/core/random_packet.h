// The random numbers of core/random.h for sixteen samples at a time: the same bits, lane by lane.
#pragma once

#include "core/packet.h"
#include "core/random.h"

namespace burnish {

/// philox4x32 of sixteen counters under one key.
inline std::array<LaneIntegers, 4> philox4x32(const std::array<LaneIntegers, 4>& counter,
                                              const std::array<std::uint32_t, 2>& key) {
    using Wide64 = std::uint64_t __attribute__((vector_size(8 * kLanes)));
    return philox_rounds(counter, key, [](std::uint32_t constant, const LaneIntegers& word) {
        const Wide64 p = __builtin_convertvector(word, Wide64) * std::uint64_t{constant};
        return WideProduct<LaneIntegers>{__builtin_convertvector(p >> 32, LaneIntegers),
                                         __builtin_convertvector(p, LaneIntegers)};
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
