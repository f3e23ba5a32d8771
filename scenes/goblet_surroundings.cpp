// What the goblet stands on and what it mirrors: a table top and an evening sky.

#include "core/constants.h"
#include "core/parallel.h"
#include "scenes/goblet.h"
#include "scenes/marks.h"

namespace burnish::procedural {

namespace {

/// A lamp far away, out of focus.
struct Bokeh {
    Vec3f direction;
    Rgbf radiance;
    float cos_inner = 1, cos_outer = 1;
};

std::vector<Bokeh> make_bokeh(std::uint32_t seed) {
    static constexpr Rgbf kHues[] = {{1.0f, 0.36f, 0.08f},
                                     {1.0f, 0.58f, 0.22f},
                                     {0.14f, 0.42f, 1.0f},
                                     {0.95f, 0.14f, 0.20f},
                                     {0.12f, 0.70f, 0.62f}};
    std::vector<Bokeh> lamps;
    for (std::uint32_t i = 0; i < 140; ++i) {
        const auto u = uniforms({seed, Stream::kScene}, i, 0, 400),
                   v = uniforms({seed, Stream::kScene}, i, 1, 400);
        const float azimuth = 2 * kPi * u[0], height = 0.05f - 0.6f * u[1] * u[1];
        const float r = std::sqrt(1 - height * height);
        const float angle = (1.0f + 1.5f * u[2]) * kPi / 180;
        const Rgbf hue = kHues[static_cast<std::size_t>(u[3] * 5)];
        lamps.push_back({{r * std::sin(azimuth), height, r * std::cos(azimuth)},
                         hue * (0.25f + 2.0f * v[0] * v[0]),
                         std::cos(angle * 0.7f),
                         std::cos(angle * 1.9f)});
    }
    return lamps;
}

/// Blue above, a band of afterglow at the horizon that is warmest where the sun went down, clouds,
/// dusk below.
Rgbf sky_radiance(const Vec3f& d, float azimuth, std::uint32_t seed) {
    const Rgbf zenith{0.05f, 0.10f, 0.26f}, dusk{0.30f, 0.20f, 0.34f}, glow{1.6f, 0.62f, 0.18f};
    const Rgbf ground{0.030f, 0.026f, 0.036f}, haze{0.07f, 0.055f, 0.09f};
    const float toward_sun = 0.5f + 0.5f * std::cos(azimuth - 2.2f);
    const Rgbf horizon = mix(dusk, glow, toward_sun * toward_sun * toward_sun);
    if (d.y < 0)
        return mix(mix(haze, horizon * 0.35f, 0.5f), ground, smooth_step(0.0f, 0.45f, -d.y));
    const Rgbf clear = mix(horizon, zenith, smooth_step(0.0f, 0.55f, d.y));
    const float cloud = fractal_noise(azimuth / (2 * kPi), 3 * d.y, 6, 500, seed);
    const Rgbf lit = mix(Rgbf{0.34f, 0.33f, 0.42f}, glow * 0.9f, toward_sun * (1 - d.y));
    return mix(clear, lit,
               0.7f * smooth_step(0.48f, 0.72f, cloud) * smooth_step(0.02f, 0.15f, d.y));
}

}  // namespace

Image make_evening_sky(int height, std::uint32_t seed) {
    const std::vector<Bokeh> lamps = make_bokeh(seed);
    Image sky = make_image(2 * height, height, 3);
    parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
        const float theta = kPi * static_cast<float>(row) / static_cast<float>(height - 1);
        for (int x = 0; x < sky.width; ++x) {
            const float azimuth =
                2 * kPi * (static_cast<float>(x) + 0.5f) / static_cast<float>(sky.width);
            const Vec3f d{std::sin(azimuth) * std::sin(theta), std::cos(theta),
                          -std::cos(azimuth) * std::sin(theta)};
            Rgbf radiance = sky_radiance(d, azimuth, seed);
            for (const Bokeh& lamp : lamps) {
                radiance += lamp.radiance *
                            smooth_step(lamp.cos_outer, lamp.cos_inner, dot(d, lamp.direction));
            }
            for (int c = 0; c < 3; ++c) sky.at(x, static_cast<int>(row), c) = radiance[c];
        }
    });
    return sky;
}

Image make_table_texture(int size, std::uint32_t seed) {
    const Rgbf walnut{0.16f, 0.075f, 0.035f}, ebony{0.022f, 0.016f, 0.014f},
        maple{0.42f, 0.26f, 0.12f};
    return painted(size, [&](float u, float v) {
        const float px = 2 * u - 1, py = 2 * v - 1;
        const float radius = std::hypot(px, py), turn = std::atan2(py, px) / (2 * kPi) + 0.5f;
        const int sector = static_cast<int>(turn * 24);
        const float grain = fractal_noise(0.02f * px + 0.37f * static_cast<float>(sector),
                                          2.5f * py + 9 * px, 40, 600, seed);
        Rgbf wood = mix(walnut * 0.55f, walnut * 1.25f, grain);
        if (radius > 0.62f && radius < 0.80f)
            wood = sector % 2 ? ebony : mix(maple * 0.7f, maple, grain);
        const bool inlay = std::fabs(radius - 0.61f) < 0.010f || std::fabs(radius - 0.81f) < 0.010f;
        if (inlay) wood = maple;
        return wood;
    });
}

}  // namespace burnish::procedural
