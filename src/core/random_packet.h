// The random numbers of core/random.h for sixteen samples at a time: the same bits, lane by lane.
#pragma once

#include "core/packet.h"
#include "core/random.h"

namespace burnish {

/// philox4x32 of sixteen counters under one key.
inline std::array<LaneIntegers, 4> philox4x32(std::array<LaneIntegers, 4> counter,
                                              std::array<std::uint32_t, 2> key) {
    using Wide = std::uint64_t __attribute__((vector_size(8 * kLanes)));
    for (int round = 0; round < 10; ++round) {
        const Wide p0 = __builtin_convertvector(counter[0], Wide) * std::uint64_t{0xD2511F53u};
        const Wide p1 = __builtin_convertvector(counter[2], Wide) * std::uint64_t{0xCD9E8D57u};
        counter = {__builtin_convertvector(p1 >> 32, LaneIntegers) ^ counter[1] ^ key[0],
                   __builtin_convertvector(p1, LaneIntegers),
                   __builtin_convertvector(p0 >> 32, LaneIntegers) ^ counter[3] ^ key[1],
                   __builtin_convertvector(p0, LaneIntegers)};
        key[0] += 0x9E3779B9u;
        key[1] += 0xBB67AE85u;
    }
    return counter;
}

inline Packet to_unit_float(const LaneIntegers& bits) {
    return to_floats(bits >> 8) * Packet(0x1p-24f);
}

/// uniforms of sixteen counters.
inline std::array<Packet, 4> uniforms(RandomKey key, const LaneIntegers& sample,
                                      const LaneIntegers& iteration, const LaneIntegers& block) {
    const auto bits = philox4x32({sample, iteration, block, LaneIntegers{}},
                                 {key.seed, static_cast<std::uint32_t>(key.stream)});
    return {to_unit_float(bits[0]), to_unit_float(bits[1]), to_unit_float(bits[2]),
            to_unit_float(bits[3])};
}

}  // namespace burnish
