// The tyre's surface: rubber, worn and dusty, with mould marks, mud and drops; the floor; the sky.

#include "core/constants.h"
#include "core/parallel.h"
#include "scenes/lettering.h"
#include "scenes/marks.h"
#include "scenes/tyre.h"

namespace burnish::procedural {

namespace {

/// paint: how much of the rubber is painted white.
struct Rubber {
    float roughness = 0.45f, paint = 0.0f;
};

/// What lies on the rubber: each [size, size, 1], how much of it.
struct Layers {
    Image scratches, drops, mud;
};

Layers make_layers(int size, std::uint32_t seed) {
    Layers layers{make_image(size, size, 1), make_image(size, size, 1), make_image(size, size, 1)};
    scratch(layers.scratches, {420, 0.01f, 0.09f, 0.10f, 0.35f}, 800, seed);
    for (std::uint32_t i = 0; i < 420; ++i) {
        const auto u = uniforms({seed, Stream::kScene}, i, 0, 801);
        const float radius = 0.002f + 0.011f * u[2] * u[2] * u[2];
        stamp(layers.drops, u[0], u[1], 1.3f * radius, [=](float dx, float dy) {
            return 1 -
                   smooth_step(0.85f, 1.15f, std::hypot(dx, dy * (0.8f + 0.5f * u[3])) / radius);
        });
    }
    for (std::uint32_t i = 0; i < 36; ++i) {  // splashes: a blot and what it threw about
        const auto u = uniforms({seed, Stream::kScene}, i, 0, 802);
        for (std::uint32_t j = 0; j < 22; ++j) {
            const auto w = uniforms({seed, Stream::kScene}, i, 1 + j, 802);
            const float away = j == 0 ? 0.0f : 0.008f + 0.05f * w[0] * w[0], turn = 2 * kPi * w[1];
            const float radius =
                j == 0 ? 0.008f + 0.014f * u[2] : 0.0012f + 0.005f * w[2] * (1 - w[0]);
            stamp(layers.mud, u[0] + away * std::cos(turn), u[1] + away * std::sin(turn),
                  1.4f * radius, [=](float dx, float dy) {
                      const float lobes = 1 + 0.2f * std::cos(5 * std::atan2(dy, dx) + 9 * w[3]);
                      return 1 - smooth_step(0.8f, 1.1f, std::hypot(dx, dy) / (radius * lobes));
                  });
        }
    }
    return layers;
}

Rubber side_wall(float s, float k, std::uint32_t seed) {
    const TyreBands band;
    const auto wiped = fractal_noise(s, 0.08f * k, 7, 810, seed);
    Rubber rubber{mix(0.22f, 0.52f, smooth_step(0.35f, 0.6f, wiped)), 0};
    const double letters = tyre_letters(static_cast<double>(s), static_cast<double>(k));
    const double y = kLetterHeight * (band.rib - 0.12 - static_cast<double>(k)) / 0.8;
    const double print =
        lettering("RADIAL TUBELESS 205 55 R16", 190 * (1 - static_cast<double>(s)) - 17, y);
    const float crack = line(cell_distance(s * 44, k * 2.5f, 44, 812, seed) - 0.62f, 0.03f);
    const auto painted = static_cast<float>(letters);
    rubber.roughness = mix(rubber.roughness, 0.30f + 0.45f * crack, painted);
    rubber.roughness = mix(rubber.roughness, 0.12f, static_cast<float>(print));
    rubber.paint = painted * (1 - 0.6f * crack);
    // Fine rings that the mould left.
    rubber.roughness += 0.05f * std::sin(2 * kPi * 9 * k) * (1 - painted);
    return rubber;
}

Rubber shoulder(float s, float k, std::uint32_t seed) {
    const bool hatched = fraction(36 * s) < 0.5f;
    const float pip =
        line(std::hypot(fraction(24 * s) - 0.5f, 1.6f * (fraction(2.5f * k) - 0.5f)), 0.14f);
    const float noise = fractal_noise(s, 0.1f * k, 11, 815, seed);
    return {mix((hatched ? 0.26f : 0.58f) + 0.3f * (noise - 0.5f), 0.14f, pip), 0};
}

Rubber tread(float s, float k, std::uint32_t seed) {
    const auto groove =
        static_cast<float>(tyre_grooves(static_cast<double>(s), static_cast<double>(k)));
    const float slant = 0.42f * (static_cast<float>(kTyreMiddle) - k);
    const float worn = value_noise(s * 400, k * 3, 400, 820, seed);
    const float block =
        lattice_value(static_cast<int>(fraction(s + slant / 18) * 36), k > 9.8f, 821, seed);
    const float sipe = line(fraction(72 * s + 0.35f * std::sin(9 * k)) - 0.5f, 0.09f);
    const float top = 0.24f + 0.30f * block + 0.22f * (worn - 0.5f);
    return {mix(mix(top, 0.78f, 0.8f * sipe), 0.86f, groove), 0};
}

Rubber rubber_at(float s, float k, std::uint32_t seed) {
    const TyreBands band;
    if (k < band.serration) return side_wall(s, k, seed);
    if (k < band.shoulder + 0.2) return shoulder(s, k, seed);
    return tread(s, k, seed);
}

}  // namespace

TyreTextures make_tyre_textures(int size, std::uint32_t seed) {
    const TyreRows rows = make_tyre_rows();
    const Layers layers = make_layers(size, seed);
    TyreTextures textures{make_image(size, size, 1), make_image(size, size, 3)};
    const Rgbf black{0.055f, 0.055f, 0.06f}, white{0.72f, 0.70f, 0.64f}, dirt{0.26f, 0.20f, 0.14f};
    parallel_for(static_cast<std::size_t>(size), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(size);
        const auto k = static_cast<float>(tyre_knot(rows, static_cast<double>(v)));
        for (int x = 0; x < size; ++x) {
            const float s = (static_cast<float>(x) + 0.5f) / static_cast<float>(size);
            const Rubber rubber = rubber_at(s, k, seed);
            const float cloud = fractal_noise(s, v, 5, 830, seed);
            const float dust = smooth_step(0.50f, 0.78f, cloud);
            const float mud = layers.mud.at(x, y, 0), drop = layers.drops.at(x, y, 0);
            float roughness =
                rubber.roughness + 0.25f * (fractal_noise(s, v, 40, 834, seed) - 0.5f);
            roughness = mix(roughness, 0.82f, 0.8f * dust) + layers.scratches.at(x, y, 0);
            roughness = mix(mix(roughness, 0.9f, mud), 0.09f, drop);
            textures.roughness.at(x, y, 0) = std::clamp(roughness, 0.07f, 0.93f);
            const Rgbf clean = mix(black, white, rubber.paint);
            const Rgbf color = mix(mix(clean, dirt, 0.35f * dust), dirt * 0.6f, mud);
            for (int c = 0; c < 3; ++c) textures.base_color.at(x, y, c) = color[c];
        }
    });
    return textures;
}

Image make_workshop_texture(int size, double floor_end, std::uint32_t seed) {
    const Rgbf concrete{0.36f, 0.35f, 0.33f}, stain{0.12f, 0.11f, 0.10f},
        yellow{0.62f, 0.42f, 0.06f};
    const Rgbf wall{0.20f, 0.26f, 0.30f}, band{0.42f, 0.41f, 0.38f};
    const auto end = static_cast<float>(floor_end);
    return painted(size, [&](float u, float v) {
        const float cloud = fractal_noise(u, v, 6, 840, seed);
        const float grain = value_noise(u * 400, v * 400, 400, 844, seed);
        Rgbf color = mix(concrete, stain, 0.7f * smooth_step(0.5f, 0.75f, cloud));
        const float joint = std::fmax(line(fraction(5 * u + 0.2f) - 0.5f, 0.006f),
                                      line(fraction(6 * v / end) - 0.5f, 0.006f));
        color = mix(color, stain * 0.6f, joint);
        const float stripe = line(u + 0.35f * v - 0.86f, 0.022f);
        color = mix(color, yellow, stripe * smooth_step(0.3f, 0.45f, 1 - cloud));
        const Rgbf plaster = mix(wall, band, smooth_step(0.0f, 0.002f, v - end - 0.20f));
        color = mix(color, plaster * (0.8f + 0.4f * cloud), smooth_step(end, end + 0.01f, v));
        return color * (0.88f + 0.24f * grain);
    });
}

Image make_dim_sky(int height, std::uint32_t seed) {
    Image sky = make_image(2 * height, height, 3);
    const Rgbf zenith{0.30f, 0.34f, 0.40f}, horizon{0.14f, 0.13f, 0.12f};
    for (int y = 0; y < height; ++y) {
        const float theta = kPi * static_cast<float>(y) / static_cast<float>(height - 1);
        for (int x = 0; x < sky.width; ++x) {
            const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(sky.width);
            const float cloud = fractal_noise(u, 2 * theta / kPi, 5, 850, seed);
            const Rgbf clear = mix(horizon, zenith, smooth_step(-0.2f, 0.8f, std::cos(theta)));
            for (int c = 0; c < 3; ++c) sky.at(x, y, c) = clear[c] * (0.6f + 0.8f * cloud);
        }
    }
    return sky;
}

}  // namespace burnish::procedural
