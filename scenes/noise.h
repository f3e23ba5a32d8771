// Noise for procedural textures: pure functions of position and seed.
#pragma once

#include <cmath>

#include "core/random.h"

namespace burnish::procedural {

/// A uniform number in [0, 1) of a lattice point.
inline float lattice_value(int x, int y, std::uint32_t layer, std::uint32_t seed) {
    return uniforms({seed, Stream::kScene}, static_cast<std::uint32_t>(x),
                    static_cast<std::uint32_t>(y), layer)[0];
}

inline float smooth(float t) { return t * t * (3 - 2 * t); }

/// 0 below e0, 1 above e1, smooth in between.
inline float smooth_step(float e0, float e1, float x) {
    return smooth(std::fmin(std::fmax((x - e0) / (e1 - e0), 0.0f), 1.0f));
}

inline float mix(float a, float b, float t) { return a + (b - a) * t; }

/// Smooth noise in [0, 1] with period `period` lattice cells in x.
inline float value_noise(float x, float y, int period, std::uint32_t layer, std::uint32_t seed) {
    const float fx = std::floor(x), fy = std::floor(y);
    const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
    const auto at = [&](int dx, int dy) {
        const int wrapped = (((ix + dx) % period) + period) % period;
        return lattice_value(wrapped, iy + dy, layer, seed);
    };
    const float tx = smooth(x - fx), ty = smooth(y - fy);
    return mix(mix(at(0, 0), at(1, 0), tx), mix(at(0, 1), at(1, 1), tx), ty);
}

/// Four octaves of value noise, in [0, 1]; x has period 1, `cells` lattice cells of the first
/// octave.
inline float fractal_noise(float x, float y, int cells, std::uint32_t layer, std::uint32_t seed) {
    float sum = 0, weight = 0.5f, total = 0;
    int period = cells;
    for (std::uint32_t octave = 0; octave < 4; ++octave) {
        sum += weight * value_noise(x * static_cast<float>(period), y * static_cast<float>(period),
                                    period, layer + 16 * octave, seed);
        total += weight;
        weight *= 0.5f;
        period *= 2;
    }
    return sum / total;
}

}  // namespace burnish::procedural
