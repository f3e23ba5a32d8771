// The bowl's finish: how strongly each place was brushed; and the stone below it.

#include "core/constants.h"
#include "core/parallel.h"
#include "scenes/bowl.h"
#include "scenes/lettering.h"
#include "scenes/marks.h"

namespace burnish::procedural {

namespace {

/// gilt: how much of the bronze is gilded; dark: how much patina lies on it.
struct Brushing {
    float strength = 0.5f, gilt = 0.0f, dark = 0.0f;
};

Brushing blend(const Brushing& a, const Brushing& b, float t) {
    return {mix(a.strength, b.strength, t), mix(a.gilt, b.gilt, t), mix(a.dark, b.dark, t)};
}

constexpr Brushing kBrushed{0.85f, 0, 0};
constexpr Brushing kSoft{0.5f, 0, 0};
constexpr Brushing kEtched{0.12f, 0, 0.5f};
constexpr Brushing kGilded{0.25f, 1, 0};

/// Petals of a rose engine around the middle.
Brushing rosette(float s, float b) {
    const float petal = 0.55f + 0.4f * std::fabs(std::cos(4 * kPi * s));
    const float rings = 0.5f + 0.5f * std::sin(2 * kPi * (7 * b + 0.8f * std::cos(8 * kPi * s)));
    const Brushing field{0.30f + 0.6f * rings, 0, 0};
    return blend(b < petal ? field : kGilded, kEtched, line(b - petal, 0.04f));
}

/// Two families of waves: a lattice of lozenges, each with a bead.
Brushing lattice(float s, float b) {
    const float bend = 1.2f * b;
    const float left = std::sin(2 * kPi * (5 * s + bend)),
                right = std::sin(2 * kPi * (5 * s - bend));
    const Brushing field{0.5f + 0.42f * left * right, 0, 0};
    const float wire = std::fmax(line(left, 0.16f), line(right, 0.16f));
    const float bead = line(std::hypot(1 - std::fabs(left), 1 - std::fabs(right)), 0.22f);
    return blend(blend(field, kEtched, 0.8f * wire), kGilded, bead);
}

/// Turned brush strokes in discs, one over the other as scales.
Brushing scales(float s, float b, int around, int along) {
    const float y = b * static_cast<float>(along);
    const auto row = static_cast<int>(y);
    const float x = fraction(s * static_cast<float>(around) + 0.5f * static_cast<float>(row % 2));
    const float distance = std::hypot((x - 0.5f) * 1.1f, y - static_cast<float>(row));
    const Brushing disc{0.2f + 0.7f * smooth_step(0.1f, 0.85f, distance), 0, 0};
    return blend(disc, kEtched, line(distance - 0.62f, 0.06f));
}

Brushing flutes(float s, float b) {
    const float lobe = fraction(6 * s);
    const bool even = static_cast<int>(6 * s) % 2 == 0;
    const Brushing crest = even ? kBrushed : scales(s, b, 24, 9);
    return blend(crest, kEtched, line(std::fabs(lobe - 0.5f) - 0.5f, 0.05f));
}

Brushing rim(float s, float b, std::uint32_t seed) {
    // One word from the rest at s = 0.5 to the next, read from outside.
    const auto x = static_cast<double>(64 * fraction(s - 0.5f) - 11.5f);
    const auto word =
        static_cast<float>(lettering("BURNISH", x, static_cast<double>(8.6f * b - 0.8f)));
    const float hammer = cell_distance(s * 26, b * 5, 26, 902, seed);
    const Brushing field{0.35f + 0.55f * std::fmin(hammer, 1.0f), 0, 0};
    const float edge = std::fmax(line(b - 0.03f, 0.02f), line(b - 0.97f, 0.02f));
    return blend(blend(field, kEtched, edge), {0.1f, 0.9f, 0}, word);
}

Brushing herringbone(float s, float b) {
    const float x = 16 * s, slope = std::fabs(fraction(x) - 0.5f);
    const float stripe = fraction(7 * b + 2.4f * slope);
    const Brushing strokes{stripe < 0.5f ? 0.82f : 0.28f, 0, 0};
    return blend(strokes, kEtched, line(slope - 0.5f, 0.05f));
}

Brushing brushing(float s, float k, std::uint32_t seed) {
    const BowlBands band;
    const auto within = [k](double begin, double end) {
        return (k - static_cast<float>(begin)) / static_cast<float>(end - begin);
    };
    if (k < band.rosette) return rosette(s, within(0, band.rosette));
    if (k < band.lattice) return lattice(s, within(band.rosette, band.lattice));
    if (k < band.flutes) return flutes(s, within(band.lattice, band.flutes));
    if (k < band.rim) return rim(s, within(band.flutes, band.rim), seed);
    if (k < band.waist) return herringbone(s, within(band.rim, band.waist));
    return blend(kSoft, kBrushed, 0.5f + 0.5f * std::sin(14 * k));
}

/// Scratches and spots that a polishing cloth left; x is around the axis, y along the curve.
Image make_bowl_wear(int size, std::uint32_t seed) {
    Image wear = make_image(size, size, 1);
    scratch(wear, {320, 0.01f, 0.10f, 0.2f, 0.7f}, 910, seed);
    for (std::uint32_t i = 0; i < 90; ++i) {
        const auto u = uniforms({seed, Stream::kScene}, i, 2, 910);
        const float radius = 0.004f + 0.02f * u[2] * u[2];
        stamp(wear, u[0], u[1], 1.5f * radius, [=](float dx, float dy) {
            return 0.8f * u[3] * (1 - smooth_step(0.5f, 1.4f, std::hypot(dx, dy) / radius));
        });
    }
    return wear;
}

Rgbf metal_color(const Brushing& f, float patina) {
    const Rgbf bronze{0.86f, 0.62f, 0.44f}, gold{0.95f, 0.74f, 0.32f}, brown{0.30f, 0.19f, 0.12f};
    const Rgbf verdigris{0.24f, 0.42f, 0.36f};
    const Rgbf clean = mix(bronze, gold, f.gilt);
    return mix(mix(clean, brown, 0.8f * f.dark), verdigris, 0.3f * smooth_step(0.6f, 0.8f, patina));
}

}  // namespace

BowlTextures make_bowl_textures(int size, std::uint32_t seed) {
    const CurveRows rows = make_bowl_rows();
    const Image wear = make_bowl_wear(size, seed);
    BowlTextures textures{make_image(size, size, 1), make_image(size, size, 3)};
    parallel_for(static_cast<std::size_t>(size), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        const float s = (static_cast<float>(y) + 0.5f) / static_cast<float>(size);
        for (int x = 0; x < size; ++x) {
            const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(size);
            const auto k = static_cast<float>(knot_at(rows, static_cast<double>(u)));
            const Brushing f = brushing(s, k, seed);
            // Strokes run around the axis.
            const float strokes = fractal_noise(s, 90 * u, 4, 920, seed);
            const float cloud = fractal_noise(s, u, 5, 924, seed);
            float strength = f.strength + 0.28f * (strokes - 0.5f) + 0.35f * (cloud - 0.5f);
            strength = mix(strength, 0.1f, wear.at(y, x, 0));
            textures.anisotropic.at(x, y, 0) = std::clamp(strength, 0.06f, 0.94f);
            const Rgbf color = metal_color(f, fractal_noise(s, u, 6, 928, seed));
            for (int c = 0; c < 3; ++c) textures.base_color.at(x, y, c) = color[c];
        }
    });
    return textures;
}

Image make_stone_texture(int size, std::uint32_t seed) {
    const Rgbf dark{0.16f, 0.20f, 0.22f}, light{0.40f, 0.44f, 0.44f}, vein{0.72f, 0.68f, 0.60f};
    return painted(size, [&](float u, float v) {
        const float warp = fractal_noise(u, v, 6, 930, seed);
        const float cloud = fractal_noise(u + 0.1f * warp, v, 14, 934, seed);
        const float ridge = std::fabs(fractal_noise(u, v + 0.15f * warp, 9, 938, seed) - 0.5f);
        const float hair = std::fabs(fractal_noise(u + 0.1f * warp, v, 23, 942, seed) - 0.5f);
        const float veins = std::fmax(1 - smooth_step(0.0f, 0.028f, ridge),
                                      0.5f * (1 - smooth_step(0.0f, 0.03f, hair)));
        return mix(mix(dark, light, smooth_step(0.3f, 0.7f, cloud)), vein,
                   veins * smooth_step(0.3f, 0.6f, warp));
    });
}

}  // namespace burnish::procedural
