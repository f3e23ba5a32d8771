// The tree's colours: boughs with frost, a woven ribbon, painted baubles and wrapped boxes; and the
// parlour around them.
#include <array>

#include "core/constants.h"
#include "scenes/marks.h"
#include "scenes/tree.h"

namespace burnish::procedural {

namespace {

constexpr Rgbf kSnow{0.86f, 0.88f, 0.90f}, kGold{0.80f, 0.52f, 0.12f}, kCream{0.85f, 0.78f, 0.62f};
constexpr std::array<Rgbf, 6> kPaints = {{{0.72f, 0.07f, 0.06f},
                                          {0.08f, 0.24f, 0.62f},
                                          {0.80f, 0.45f, 0.08f},
                                          {0.07f, 0.42f, 0.34f},
                                          {0.52f, 0.12f, 0.48f},
                                          {0.84f, 0.80f, 0.72f}}};

const Rgbf& paint(int index) { return kPaints[static_cast<std::size_t>(index) % kPaints.size()]; }

/// Needles that lie aslant along the spine of each bough, ends with frost.
Rgbf boughs(float s, float v, std::uint32_t seed) {
    int tier = 0;
    while (tier + 1 < kTiers && static_cast<double>(v) > bough_row(tier, 1)) ++tier;
    const auto top = static_cast<float>(bough_row(tier, 0)),
               edge = static_cast<float>(bough_row(tier, 1));
    const float t = std::clamp((v - top) / (edge - top), 0.0f, 1.0f);
    const auto count = static_cast<float>(boughs_of(tier));
    const float x = fraction(s * count + 0.5f) - 0.5f;  // 0 on the spine
    const auto bough = static_cast<int>(fraction(s + 0.5f / count) * count);
    const float shade = lattice_value(bough, tier, 1200, seed);
    const float slant = 30 * t - 26 * std::fabs(x);
    const float needle = fraction(slant + 0.3f * value_noise(s * 160, t * 30, 160, 1201, seed));
    const Rgbf deep{0.055f, 0.13f, 0.065f}, fresh{0.16f + 0.12f * shade, 0.44f, 0.14f},
        blue{0.10f, 0.36f, 0.27f};
    const Rgbf tip =
        mix(fresh, blue, smooth_step(0.45f, 0.65f, fractal_noise(s, t, 6, 1202, seed)));
    Rgbf color =
        mix(deep, tip, 0.25f + 0.75f * smooth_step(0.1f, 0.9f, needle) * (0.4f + 0.6f * t));
    color = mix(color, Rgbf{0.30f, 0.17f, 0.08f}, line(x, 0.025f) * (1 - 0.5f * t));
    const float frost = fractal_noise(s, 0.7f * t, 17, 1206, seed) + 0.75f * t - 0.15f * needle;
    color = mix(color, kSnow, 0.85f * smooth_step(0.98f, 1.22f, frost));
    const float berry = cell_distance(s * 34, t * (4 + static_cast<float>(tier)), 34, 1210, seed);
    return mix(color, Rgbf{0.75f, 0.10f, 0.08f}, line(berry, 0.13f) * smooth_step(0.3f, 0.5f, t));
}

/// y in [0, 1] across; the weave repeats with s.
Rgbf ribbon(float s, float y, std::uint32_t seed) {
    const float thread = std::sin(2 * kPi * 96 * s) * std::sin(2 * kPi * 24 * y);
    const float band = std::fabs(y - 0.5f);
    Rgbf color = mix(paint(0), paint(0) * 0.55f, 0.5f + 0.5f * thread);
    const float star = std::hypot(fraction(4 * s) - 0.5f, 0.8f * (y - 0.5f));
    const float points = 0.17f + 0.08f * std::cos(5 * std::atan2(y - 0.5f, fraction(4 * s) - 0.5f));
    color = mix(color, kCream, 1 - smooth_step(0.9f * points, 1.1f * points, star));
    color = mix(color, kGold * (0.8f + 0.2f * thread), smooth_step(0.34f, 0.37f, band));
    return color * (0.8f + 0.4f * fractal_noise(s, y, 24, 1220, seed));
}

/// A painted pattern on a tile; x and y in [0, 1], y down.
Rgbf tile_pattern(int tile, float x, float y, std::uint32_t seed) {
    const Rgbf &ground = paint(tile), &figure = paint(tile * 5 / 2 + 3);
    const float dx = x - 0.5f, dy = y - 0.5f, r = std::hypot(dx, dy), angle = std::atan2(dy, dx);
    switch (tile % 8) {
        case 0:
            return mix(ground, figure,
                       smooth_step(-0.15f, 0.15f, std::sin(2 * kPi * (4 * x + 5 * y))));
        case 1: {
            const float zigzag = fraction(8 * y + 0.6f * std::fabs(fraction(5 * x) - 0.5f));
            return mix(zigzag < 0.25f ? kGold : figure, ground, smooth_step(0.47f, 0.53f, zigzag));
        }
        case 2: {
            const float dots = cell_distance(7 * x, 7 * y, 7, 1230, seed);
            return mix(figure, ground, smooth_step(0.26f, 0.34f, dots));
        }
        case 3: {
            const float flake =
                0.30f * std::fabs(std::cos(3 * angle)) + 0.08f * std::cos(18 * angle);
            return mix(kSnow, ground, smooth_step(flake - 0.02f, flake + 0.02f, r - 0.06f));
        }
        case 4:
            return mix(ground, kCream, line(fraction(9 * r) - 0.5f, 0.2f));
        case 5: {
            const bool check = (static_cast<int>(8 * x) + static_cast<int>(8 * y)) % 2 == 0;
            const float cross =
                std::fmax(line(fraction(8 * x) - 0.5f, 0.08f), line(fraction(8 * y) - 0.5f, 0.08f));
            return mix(check ? ground : ground * 0.6f, figure, cross);
        }
        case 6: {
            const float swirl = std::sin(5 * angle + 16 * r);
            return mix(ground, figure, smooth_step(-0.2f, 0.2f, swirl));
        }
        default: {
            const float cracks = cell_distance(11 * x, 11 * y, 11, 1234, seed);
            return mix(ground, kGold, smooth_step(0.5f, 0.75f, cracks));
        }
    }
}

/// A tile: pattern, gilt bands, a cap on top, flaking paint.
Rgbf tile_color(int tile, float x, float y, std::uint32_t seed) {
    const auto index = static_cast<std::uint32_t>(tile);
    Rgbf color = tile_pattern(tile, x, y, seed);
    const float bands = std::fmax(line(y - 0.26f, 0.02f), line(y - 0.74f, 0.02f));
    color = mix(color, kGold, bands);
    const float wear = fractal_noise(x, y, 9, 1240 + index, seed);
    color = mix(color, Rgbf{0.50f, 0.47f, 0.42f}, 0.7f * smooth_step(0.62f, 0.68f, wear));
    const float glaze = value_noise(60 * x, 60 * y, 60, 1300 + index, seed);
    color = color * (0.84f + 0.3f * glaze);
    return mix(kGold * (0.7f + 0.3f * std::cos(40 * kPi * x)), color,
               smooth_step(0.07f, 0.085f, y));
}

Rgbf atlas(float u, float v, std::uint32_t seed) {
    const auto boughs_end = static_cast<float>(kBoughsEnd),
               ribbon_end = static_cast<float>(kRibbonEnd);
    if (v < boughs_end) return boughs(u, v, seed);
    if (v < ribbon_end) return ribbon(u, (v - boughs_end) / (ribbon_end - boughs_end), seed);
    const float x = u * kTiles, y = (v - ribbon_end) * kTiles;
    const int column = std::min(static_cast<int>(x), kTiles - 1);
    const int row = std::min(static_cast<int>(y), kTileRows - 1);
    return tile_color(row * kTiles + column, x - static_cast<float>(column),
                      y - static_cast<float>(row), seed);
}

}  // namespace

Image make_tree_texture(int size, std::uint32_t seed) {
    return painted(size, [&](float u, float v) {
        const Rgbf color = atlas(u, v, seed);
        return Rgbf{std::clamp(color.x, 0.05f, 0.95f), std::clamp(color.y, 0.05f, 0.95f),
                    std::clamp(color.z, 0.05f, 0.95f)};
    });
}

Image make_parlour_texture(int size, double floor_end, std::uint32_t seed) {
    const Rgbf oak{0.42f, 0.24f, 0.12f}, gap{0.06f, 0.035f, 0.02f};
    const Rgbf paper{0.42f, 0.12f, 0.12f}, figure{0.52f, 0.20f, 0.14f}, wood{0.50f, 0.42f, 0.32f};
    const auto end = static_cast<float>(floor_end);
    return painted(size, [&](float u, float v) {
        const int board = static_cast<int>(u * 22);
        const float grain =
            fractal_noise(u * 3 + 0.37f * static_cast<float>(board), 0.25f * v, 64, 1400, seed);
        Rgbf floor = oak * (0.6f + 0.5f * grain + 0.25f * lattice_value(board, 0, 1404, seed));
        floor = mix(floor, gap, smooth_step(0.46f, 0.49f, std::fabs(fraction(u * 22) - 0.5f)));
        const float leaf = std::sin(2 * kPi * 26 * u) * std::sin(2 * kPi * 26 * v);
        Rgbf wall = mix(paper, figure, smooth_step(0.35f, 0.45f, std::fabs(leaf)));
        wall = mix(wood, wall, smooth_step(0.0f, 0.002f, v - end - 0.11f));
        return v < end ? floor : wall;
    });
}

}  // namespace burnish::procedural
