// Counter-based random numbers: Philox4x32-10 [Salmon et al. 2011, "Parallel Random Numbers: As
// Easy as 1, 2, 3"]. Every number is a pure function of (seed, stream, iteration, sample,
// dimension): the same for any number of threads and in any order, and a sample can be replayed
// from its counter alone.
#pragma once

#include <array>
#include <cstdint>

#include "burnish/options.h"

namespace burnish {

/// Independent streams of random numbers of one job.
enum class Stream : std::uint32_t {
    kImage = 1,       ///< primal image
    kDerivative = 2,  ///< derivative samples, independent of the image [PR sec. 2.2]
    kTarget = 3,      ///< target image made from the scene's own textures
    kEvaluation = 4,  ///< fresh samples that evaluate a result
    kFilmOffset = 5,  ///< sub-pixel offset of a pass
    kReservoir = 6,   ///< decisions of the reservoirs
    kScene = 7,       ///< procedural scenes
    kTest = 8,
    kCacheA = 9,  ///< the two halves of a path cache, independent of one another
    kCacheB = 10,
    kScramble = 11,  ///< seeds that scramble low-discrepancy sequences
    kAdaptive = 12,  ///< how many derivative samples a pixel gets
    kTrial = 13,     ///< a few samples that tell how many records a path cache will keep
    kSearch = 14,    ///< samples by which the start is searched
    kViews = 15,     ///< the order of views, and the seeds of their numbers
    kProbe = 16,     ///< signs of pixels that tell what texels do to them
    kHalf = 17,      ///< seeds of second halves
    kAperture = 18,  ///< where a camera sample passes a thin lens
};

/// The high and the low half of a product of two words.
template <class Word>
struct WideProduct {
    Word high, low;
};

/// The rounds on words of any kind. multiply(constant, word) -> WideProduct<Word>.
template <class Word, class Multiply>
std::array<Word, 4> philox_rounds(std::array<Word, 4> counter, std::array<std::uint32_t, 2> key,
                                  const Multiply& multiply) {
    for (int round = 0; round < 10; ++round) {
        const WideProduct<Word> p0 = multiply(0xD2511F53u, counter[0]);
        const WideProduct<Word> p1 = multiply(0xCD9E8D57u, counter[2]);
        counter = {p1.high ^ counter[1] ^ key[0], p1.low, p0.high ^ counter[3] ^ key[1], p0.low};
        key[0] += 0x9E3779B9u;
        key[1] += 0xBB67AE85u;
    }
    return counter;
}

inline std::array<std::uint32_t, 4> philox4x32(const std::array<std::uint32_t, 4>& counter,
                                               const std::array<std::uint32_t, 2>& key) {
    return philox_rounds(counter, key, [](std::uint32_t constant, std::uint32_t word) {
        const std::uint64_t p = std::uint64_t{constant} * word;
        return WideProduct<std::uint32_t>{static_cast<std::uint32_t>(p >> 32),
                                          static_cast<std::uint32_t>(p)};
    });
}

/// 24 random bits to [0, 1).
inline float to_unit_float(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

/// 48 random bits of two independent uniforms in [0, 1), where the 24 of one are too few: for a
/// choice among many. Below 1.
inline double fine_uniform(float u, float finer) {
    return static_cast<double>(u) + 0x1p-24 * static_cast<double>(finer);
}

/// The key of a job's stream.
struct RandomKey {
    std::uint32_t seed = 0;
    Stream stream = Stream::kTest;
};

/// A seed for each of two halves that are to be independent; that of the first one is `seed`.
inline std::uint32_t seed_of_half(std::uint32_t seed, std::uint32_t half) {
    if (half == 0) return seed;
    return philox4x32({half, 0, 0, 0}, {seed, static_cast<std::uint32_t>(Stream::kHalf)})[0];
}

/// Four independent uniforms in [0, 1) of counter (sample, iteration, block, bounce).
inline std::array<float, 4> uniforms(RandomKey key, std::uint32_t sample, std::uint32_t iteration,
                                     std::uint32_t block, std::uint32_t bounce = 0) {
    const auto bits = philox4x32({sample, iteration, block, bounce},
                                 {key.seed, static_cast<std::uint32_t>(key.stream)});
    return {to_unit_float(bits[0]), to_unit_float(bits[1]), to_unit_float(bits[2]),
            to_unit_float(bits[3])};
}

}  // namespace burnish
