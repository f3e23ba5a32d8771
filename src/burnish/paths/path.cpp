#include "burnish/paths/path.h"

namespace burnish {

namespace {

std::uint32_t reverse_bits(std::uint32_t x) {
    x = (x << 16) | (x >> 16);
    x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
    x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
    return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

/// Second dimension of Sobol's sequence.
std::uint32_t sobol_1(std::uint32_t n) {
    std::uint32_t result = 0;
    for (std::uint32_t v = 1u << 31; n != 0; n >>= 1, v ^= v >> 1)
        if (n & 1) result ^= v;
    return result;
}

}  // namespace

Vec2f film_offset(RandomKey key, std::uint32_t film_pass) {
    // A random digital shift: each point is uniform on its own, the sequence stays well
    // distributed.
    const auto shift = philox4x32({0, 0, 0, static_cast<std::uint32_t>(Stream::kFilmOffset)},
                                  {key.seed, static_cast<std::uint32_t>(key.stream)});
    return {to_unit_float(reverse_bits(film_pass) ^ shift[0]),
            to_unit_float(sobol_1(film_pass) ^ shift[1])};
}

}  // namespace burnish
