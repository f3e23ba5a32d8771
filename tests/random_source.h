// A run of uniforms for tests: counter-based, so that a test's numbers are named by its seed alone.
#pragma once

#include <cstdint>

#include "core/random.h"

namespace burnish::test {

struct RandomSource {
    std::uint32_t seed = 0;
    std::uint32_t drawn = 0;

    /// Uniform in [0, 1).
    float next() {
        const std::uint32_t i = drawn++;
        if (i % 4 == 0) block = uniforms({seed, Stream::kTest}, i / 4, 0, 0);
        return block[i % 4];
    }
    /// Uniform in [low, high).
    float next(float low, float high) { return low + (high - low) * next(); }

    std::array<float, 4> block{};
};

}  // namespace burnish::test
