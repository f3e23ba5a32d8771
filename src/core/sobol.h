// Low-discrepancy numbers: points of Sobol's sequence, scrambled for each sample in its own way by
// hashing [B20; LK11].
//
//   u_d(n) = h(s_d + x_d(n)),   x_d: point n of the sequence, s_d: 32 random bits
//
// Sum and hash take the bits in reversed order. There they change a bit only by those before it,
// so they map an interval [i, i + 1) / 2^k onto another one: points that fill such intervals evenly
// still do. For a given n the sum runs over all words as s_d does, and h is a bijection: over the
// seeds the four numbers of one point are exactly uniform and independent of each other, so an
// estimator of one point stays as unbiased as with independent numbers, and a mean over points too.
// What is no longer independent is one point of another.
//
// Two blocks of numbers whose points come in the same order would be functions of each other: what
// reads both would go to another mean in every sample, however many points there are. All blocks
// but the first two, which nothing reads together, have an order of their own [B20]: the bits of n,
// those that weigh most first, are hashed in the same way, which maps an aligned run of 2^k points
// onto another one.
#pragma once

#include "core/random_packet.h"

namespace burnish {

/// Bits in the opposite order. U: std::uint32_t or LaneIntegers, as in all of this file.
template <class U>
constexpr U reverse_bits(U x) {
    x = (x << 16) | (x >> 16);
    x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
    x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
    return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

inline constexpr std::size_t kSobolDimensions = 7;

/// What bit k of n adds to x_d(n): word k of dimension d, in reversed bits.
using SobolDirections = std::array<std::array<std::uint32_t, 32>, kSobolDimensions>;

/// From the primitive polynomials and first numbers of [JK08].
constexpr SobolDirections make_sobol_directions() {
    struct Row {
        std::uint32_t degree, coefficients;
        std::array<std::uint32_t, 4> m;
    };
    constexpr Row kRows[] = {{1, 0, {1}},       {2, 1, {1, 3}},       {3, 1, {1, 3, 1}},
                             {3, 2, {1, 1, 1}}, {4, 1, {1, 1, 3, 3}}, {4, 4, {1, 3, 5, 13}}};
    SobolDirections directions{};
    for (std::uint32_t k = 0; k < 32; ++k) directions[0][k] = 1u << (31 - k);
    for (std::size_t d = 1; d < kSobolDimensions; ++d) {
        const auto& [degree, coefficients, m] = kRows[d - 1];
        auto& v = directions[d];
        for (std::uint32_t k = 0; k < 32; ++k) {
            if (k < degree) {
                v[k] = m[k] << (31 - k);
                continue;
            }
            v[k] = v[k - degree] ^ (v[k - degree] >> degree);
            for (std::uint32_t j = 1; j < degree; ++j)
                if ((coefficients >> (degree - 1 - j)) & 1) v[k] ^= v[k - j];
        }
    }
    for (auto& v : directions)
        for (std::uint32_t& word : v) word = reverse_bits(word);
    return directions;
}
inline constexpr SobolDirections kSobolDirections = make_sobol_directions();

inline std::uint32_t bits_in_any_lane(std::uint32_t n) { return n; }
inline std::uint32_t bits_in_any_lane(const LaneIntegers& n) {
    std::uint32_t bits = 0;
    for (int lane = 0; lane < kLanes; ++lane) bits |= get(n, lane);
    return bits;
}

/// x_d(n) of `count` dimensions from d = first, in reversed bits.
template <std::size_t first, std::size_t count, class U>
std::array<U, count> sobol_reversed(const U& n) {
    std::array<U, count> x{};
    const std::uint32_t used = bits_in_any_lane(n);
    for (std::uint32_t k = 0; k < 32 && used >> k != 0; ++k) {
        const U chosen = U{} - ((n >> k) & 1u);
        for (std::size_t d = 0; d < count; ++d) x[d] ^= chosen & kSobolDirections[first + d][k];
    }
    return x;
}

/// h(seed + x), in reversed bits.
template <class U>
U scramble_reversed(U x, const U& seed) {
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    return x ^ (x * 0x8d22f6e6u);
}

/// u_d(n) of x_d(n), in reversed bits, and s_d.
template <class U>
auto sobol_uniform(const U& x, const U& seed) {
    return to_unit_float(reverse_bits(scramble_reversed(x, seed)));
}

/// Four times 32 random bits of a sample and block.
template <class U>
std::array<U, 4> sobol_seeds(RandomKey key, const U& sample, std::uint32_t block,
                             std::uint32_t number) {
    return philox4x32(std::array<U, 4>{sample, U{} + number, U{} + block,
                                       U{} + static_cast<std::uint32_t>(Stream::kScramble)},
                      {key.seed, static_cast<std::uint32_t>(key.stream)});
}

/// The blocks whose points come in the order of the sequence; no sample reads both.
inline constexpr std::uint32_t kSobolBlocksInOrder = 2;

/// The point that comes n-th in a sample and block.
template <class U>
U sobol_point(RandomKey key, const U& sample, const U& n, std::uint32_t block) {
    if (block < kSobolBlocksInOrder) return n;
    return reverse_bits(scramble_reversed(reverse_bits(n), sobol_seeds(key, sample, block, 1)[0]));
}

/// Point n, in dimensions 0 to 3, of the sequence of a sample and block: numbers in [0, 1), uniform
/// and independent over seeds. Other samples, blocks, seeds and streams have independent sequences.
template <class U>
auto sobol_uniforms(RandomKey key, const U& sample, const U& n, std::uint32_t block) {
    const auto seeds = sobol_seeds(key, sample, block, 0);
    const auto x = sobol_reversed<0, 4>(sobol_point(key, sample, n, block));
    std::array<decltype(to_unit_float(n)), 4> u;
    for (std::size_t d = 0; d < 4; ++d) u[d] = sobol_uniform(x[d], seeds[d]);
    return u;
}

/// A fifth number of the same point: dimension 6, for 4 and 5 are those of the film offset.
template <class U>
auto sobol_fifth(RandomKey key, const U& sample, const U& n, std::uint32_t block) {
    const U x = sobol_reversed<6, 1>(sobol_point(key, sample, n, block))[0];
    return sobol_uniform(x, sobol_seeds(key, sample, block, 2)[0]);
}

}  // namespace burnish
