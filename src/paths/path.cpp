#include "paths/path.h"

#include "core/sobol.h"

namespace burnish {

Vec2f film_offset(RandomKey key, std::uint32_t film_pass, Sequence sequence) {
    const std::array<std::uint32_t, 4> counter{0, 0, 0,
                                               static_cast<std::uint32_t>(Stream::kFilmOffset)};
    const auto seeds = philox4x32(counter, {key.seed, static_cast<std::uint32_t>(key.stream)});
    if (sequence == Sequence::kSobol) {
        const auto x = sobol_reversed<4, 2>(film_pass);
        return {sobol_uniform(x[0], seeds[0]), sobol_uniform(x[1], seeds[1])};
    }
    // A random digital shift: each point is uniform on its own, the sequence stays well
    // distributed.
    const auto x = sobol_reversed<0, 2>(film_pass);
    return {to_unit_float(reverse_bits(x[0]) ^ seeds[0]),
            to_unit_float(reverse_bits(x[1]) ^ seeds[1])};
}

RandomKey aperture_key(RandomKey key) {
    const std::array<std::uint32_t, 4> counter{0, 0, 0,
                                               static_cast<std::uint32_t>(Stream::kAperture)};
    return {philox4x32(counter, {key.seed, static_cast<std::uint32_t>(key.stream)})[0],
            Stream::kAperture};
}

}  // namespace burnish
