// The goblet's finish: a function of (s, k), s in [0, 1) around one repeat and k the knot
// coordinate, plus scratches and spots that are drawn into a layer of wear first.

#include "core/constants.h"
#include "core/parallel.h"
#include "scenes/goblet.h"
#include "scenes/marks.h"

namespace burnish::procedural {

namespace {

/// gold: how much of the silver is gilded; dark: how much tarnish lies in the engraving.
struct Finish {
    float roughness = 0.3f, gold = 0.0f, dark = 0.0f;
};

Finish blend(const Finish& a, const Finish& b, float t) {
    return {mix(a.roughness, b.roughness, t), mix(a.gold, b.gold, t), mix(a.dark, b.dark, t)};
}

constexpr Finish kPolished{0.13f, 0, 0};
constexpr Finish kSatin{0.32f, 0, 0};
constexpr Finish kEngraved{0.68f, 0, 0.55f};
constexpr Finish kGildedFinish{0.2f, 1, 0};
constexpr Finish kMatteGold{0.48f, 1, 0.1f};

Finish meander(float s, float b) {
    static constexpr const char* kKey[] = {"########", ".......#", ".#####.#", ".#...#.#",
                                           ".#.###.#", ".#.....#", ".#######"};
    if (b < 0.12f || b > 0.88f)
        return blend(kPolished, kEngraved, line(std::fabs(b - 0.5f) - 0.44f, 0.025f));
    const auto row = static_cast<std::size_t>(std::min((b - 0.12f) / 0.76f * 7, 6.0f));
    const auto column = static_cast<std::size_t>(std::min(fraction(8 * s) * 8, 7.0f));
    return kKey[row][column] == '#' ? kMatteGold : kPolished;
}

Finish medallions(float s, float b) {
    const float x = (fraction(2 * s) - 0.5f) * 2.6f, y = (b - 0.5f) * 2;
    const float radius = std::hypot(x, y), angle = std::atan2(y, x);
    if (radius < 0.16f) return kGildedFinish;
    if (radius < 0.78f) {
        const float petal = 0.2f + 0.52f * std::fabs(std::cos(4 * angle));
        const float vein = line(std::sin(4 * angle), 0.12f);
        const Finish field = blend(kPolished, kEngraved, line(radius - petal, 0.03f));
        return radius < petal ? blend({0.5f, 0.25f, 0}, kEngraved, vein * 0.6f) : field;
    }
    if (radius < 0.9f)
        return blend(kMatteGold, kEngraved, line(fraction(angle * 18 / kPi) - 0.5f, 0.18f));
    const float across = fraction(14 * s + 3.5f * b) - 0.5f,
                along = fraction(14 * s - 3.5f * b) - 0.5f;
    const float lozenge = std::fmax(line(across, 0.07f), line(along, 0.07f));
    const float bead = line(std::hypot(std::fabs(across) - 0.5f, std::fabs(along) - 0.5f), 0.16f);
    return blend(blend(kSatin, kEngraved, lozenge), kGildedFinish, bead);
}

Finish gadroons(float s, float b) {
    const float lobe = fraction(6 * s);
    const bool even = static_cast<int>(6 * s) % 2 == 0;
    const Finish crest = even ? Finish{0.16f, 0, 0} : Finish{0.46f, 0.85f, 0};
    const float shade = 0.1f * std::fabs(lobe - 0.5f) * (1 - b);
    Finish f = blend(crest, kEngraved, line(std::fabs(lobe - 0.5f) - 0.5f, 0.06f + 0.05f * b));
    f.roughness += shade;
    return f;
}

/// Hammered metal: `cells` dents around and `cells` * b along.
Finish hammered(float s, float b, int cells, std::uint32_t seed) {
    const auto scale = static_cast<float>(cells);
    const float nearest = cell_distance(s * scale, b * scale, cells, 40, seed);
    return {0.14f + 0.5f * std::fmin(nearest, 1.0f), 0, 0.3f * smooth_step(0.6f, 1.0f, nearest)};
}

Finish spiral(float s, float b) {
    const float turn = fraction(2 * s + 1.5f * b);
    const Finish stripe = turn < 0.5f ? Finish{0.22f, 0, 0} : Finish{0.5f, 0, 0.1f};
    return blend(stripe, kGildedFinish, line(turn - 0.5f, 0.06f));
}

Finish petals(float s, float b, std::uint32_t seed) {
    const float x = (fraction(4 * s) - 0.5f) * 2;
    const float half_width = 0.92f * std::sqrt(std::fmax(b * (1.05f - b), 0.0f)) * 2;
    const float edge = std::fabs(x) - half_width;
    const Finish leaf = blend({0.22f + 0.25f * b, 0, 0}, kEngraved, line(x, 0.05f));
    const float stipple =
        lattice_value(static_cast<int>(s * 150), static_cast<int>(b * 40), 50, seed);
    const Finish ground = stipple > 0.72f ? kEngraved : Finish{0.56f, 0.9f, 0.1f};
    return blend(edge < 0 ? leaf : ground, kGildedFinish, line(edge, 0.09f));
}

Finish finish(float s, float k, std::uint32_t seed) {
    const GobletBands band;
    const auto within = [k](float begin, float end) { return (k - begin) / (end - begin); };
    if (k < band.rim) return blend(kPolished, kEngraved, line(within(0, band.rim) - 0.7f, 0.04f));
    if (k < band.frieze) return meander(s, within(band.rim, band.frieze));
    if (k < band.belly) return medallions(s, within(band.frieze, band.belly));
    if (k < band.gadroons) return gadroons(s, within(band.belly, band.gadroons));
    if (k < band.neck) return blend(kSatin, kPolished, 0.5f + 0.5f * std::sin(20 * k));
    if (k < band.knop) return hammered(s, within(band.neck, band.knop), 7, seed);
    if (k < band.stem) return spiral(s, within(band.knop, band.stem));
    if (k < band.foot) return petals(s, within(band.stem, band.foot), seed);
    return blend(kPolished, kMatteGold, line(k - band.foot - 0.5f, 0.2f));
}

/// Scratches and dried drops: how much rougher a texel has become.
Image make_goblet_wear(int size, std::uint32_t seed) {
    Image wear = make_image(size, size, 1);
    scratch(wear, {}, 100, seed);
    for (std::uint32_t i = 0; i < 70; ++i) {
        const auto u = uniforms({seed, Stream::kScene}, i, 2, 100);
        const float radius = 0.006f + 0.022f * u[2] * u[2];
        stamp(wear, u[0], u[1], 2 * radius, [=](float dx, float dy) {
            const float distance = std::hypot(dx, 1.6f * dy) / radius;
            return 0.32f * line(distance - 1, 0.22f) +
                   0.12f * (1 - smooth_step(0.8f, 1.1f, distance)) * u[3];
        });
    }
    return wear;
}

Rgbf metal_color(const Finish& f, float noise) {
    const Rgbf silver{0.93f, 0.90f, 0.85f}, gold{0.98f, 0.71f, 0.29f}, tarnish{0.20f, 0.16f, 0.14f};
    const Rgbf clean = silver * (1 - f.gold) + gold * f.gold;
    const float dirt = std::fmin(0.8f * f.dark + 0.35f * smooth_step(0.5f, 0.75f, noise), 0.9f);
    return clean * (1 - dirt) + tarnish * dirt;
}

}  // namespace

GobletTextures make_goblet_textures(int size, std::uint32_t seed) {
    const CurveRows rows = make_goblet_rows();
    const Image wear = make_goblet_wear(size, seed);
    GobletTextures textures{make_image(size, size, 1), make_image(size, size, 3)};
    parallel_for(static_cast<std::size_t>(size), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(size);
        const auto k = static_cast<float>(knot_at(rows, static_cast<double>(v)));
        for (int x = 0; x < size; ++x) {
            const float s = (static_cast<float>(x) + 0.5f) / static_cast<float>(size);
            const Finish f = finish(s, k, seed);
            const float smudge = fractal_noise(s, v, 5, 200, seed),
                        tarnish = fractal_noise(s, v, 7, 300, seed);
            const float roughness = f.roughness + 0.3f * (smudge - 0.5f) + wear.at(x, y, 0);
            textures.roughness.at(x, y, 0) = std::clamp(roughness, 0.1f, 0.8f);
            const Rgbf color = metal_color(f, tarnish);
            for (int c = 0; c < 3; ++c) textures.base_color.at(x, y, c) = color[c];
        }
    });
    return textures;
}

}  // namespace burnish::procedural
