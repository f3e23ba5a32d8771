// Marks that textures are drawn with: lines, cells and stamps. Positions are in units of the
// texture; x wraps around.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/parallel.h"
#include "image/image.h"
#include "scenes/noise.h"

namespace burnish::procedural {

inline float fraction(float x) { return x - std::floor(x); }

/// 1 on a line of half-width `width` around distance 0, soft over a fifth of it on either side.
inline float line(float distance, float width) {
    return 1 - smooth_step(0.8f * width, 1.2f * width, std::fabs(distance));
}

inline Rgbf mix(const Rgbf& a, const Rgbf& b, float t) { return a * (1 - t) + b * t; }

/// Distance to the nearest of jittered points, one in each unit cell; x has period `period` cells.
/// The jitter takes the layers `layer` and `layer` + 1.
inline float cell_distance(float x, float y, int period, std::uint32_t layer, std::uint32_t seed) {
    float nearest = 4;
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            const int ix = static_cast<int>(std::floor(x)) + dx,
                      iy = static_cast<int>(std::floor(y)) + dy;
            const int wrapped = (ix + period) % period;
            const float px = static_cast<float>(ix) + lattice_value(wrapped, iy + 8, layer, seed);
            const float py =
                static_cast<float>(iy) + lattice_value(wrapped, iy + 8, layer + 1, seed);
            nearest = std::fmin(nearest, std::hypot(px - x, py - y));
        }
    }
    return nearest;
}

/// A texture [size, size, 3] of the colours color(u, v) at the middles of its texels; v grows down.
template <class Color>
Image painted(int size, const Color& color) {
    Image image = make_image(size, size, 3);
    parallel_for(static_cast<std::size_t>(size), [&](std::size_t row) {
        const float v = (static_cast<float>(row) + 0.5f) / static_cast<float>(size);
        for (int x = 0; x < size; ++x) {
            const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(size);
            const Rgbf c = color(u, v);
            for (int i = 0; i < 3; ++i) image.at(x, static_cast<int>(row), i) = c[i];
        }
    });
    return image;
}

/// Raises the layer to inside(dx, dy) for offsets of up to `reach` around (x, y).
template <class Inside>
void stamp(Image& layer, float x, float y, float reach, const Inside& inside) {
    const auto size = static_cast<float>(layer.width);
    const int x0 = static_cast<int>(std::floor((x - reach) * size));
    const int x1 = static_cast<int>(std::ceil((x + reach) * size));
    const int y0 = std::max(0, static_cast<int>((y - reach) * size));
    const int y1 = std::min(layer.height - 1, static_cast<int>(std::ceil((y + reach) * size)));
    for (int j = y0; j <= y1; ++j) {
        for (int i = x0; i <= x1; ++i) {
            const float dx = (static_cast<float>(i) + 0.5f) / size - x;
            const float dy = (static_cast<float>(j) + 0.5f) / size - y;
            const int wrapped = ((i % layer.width) + layer.width) % layer.width;
            float& texel = layer.at(wrapped, j, 0);
            texel = std::fmax(texel, inside(dx, dy));
        }
    }
}

/// Which scratches are drawn: `count` of them, up to `longest` long to either side.
struct Scratches {
    std::uint32_t count = 260;
    float shortest = 0.02f, longest = 0.13f;  ///< half-lengths
    float faintest = 0.12f, deepest = 0.40f;  ///< value on a scratch
};

/// Raises the layer along bent scratches. Takes blocks 0 and 1 of the counters of `layer_index`.
inline void scratch(Image& layer, const Scratches& what, std::uint32_t layer_index,
                    std::uint32_t seed) {
    const float texel = 1.0f / static_cast<float>(layer.width);
    for (std::uint32_t i = 0; i < what.count; ++i) {
        const auto u = uniforms({seed, Stream::kScene}, i, 0, layer_index),
                   v = uniforms({seed, Stream::kScene}, i, 1, layer_index);
        const float length = what.shortest + (what.longest - what.shortest) * v[0] * v[0];
        const float angle = kPi * u[2], cosine = std::cos(angle), sine = std::sin(angle);
        const float width = std::fmax(0.0009f, 0.7f * texel);
        const float depth = what.faintest + (what.deepest - what.faintest) * u[3];
        stamp(layer, u[0], u[1], length, [=](float dx, float dy) {
            const float along = dx * cosine + dy * sine;
            const float across = dy * cosine - dx * sine + 6 * (v[1] - 0.5f) * along * along;
            return std::fabs(along) < length ? depth * line(across, width) : 0.0f;
        });
    }
}

}  // namespace burnish::procedural
