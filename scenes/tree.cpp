// The tree's shape.
#include "scenes/tree.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenes/noise.h"
#include "scenes/turned.h"

namespace burnish::procedural {

namespace {

using Vec3d = Vec3<double>;
using std::numbers::pi;
/// Keeps texture coordinates off the neighbours in the atlas.
constexpr double kInset = 0.02;

/// A tier's upper side, from (top_radius, top) out and down to (edge_radius, edge).
struct Tier {
    double top_radius, top, edge_radius, edge;
};
Tier tier_of(int i) {
    const double top = 2.04 - 0.33 * i;
    return {0.03 + 0.10 * i, top, 0.27 + 0.145 * i, top - 0.47};
}

/// 1 along the spine of a bough, 0 half way to the next.
double wave(double turn, int tier) {
    const int boughs = kTreeRepeats * boughs_of(tier);
    const double c = std::cos(pi * boughs * turn), round = 0.12;
    return (std::hypot(c, round) - round) / (std::hypot(1, round) - round);
}

Vec3d bough_point(int i, double turn, double t) {
    const Tier tier = tier_of(i);
    const double lobe = wave(turn, i);
    const double r =
        std::lerp(tier.top_radius, tier.edge_radius, t) + 0.16 * tier.edge_radius * t * t * lobe;
    const double fall = 1 - std::pow(1 - 0.98 * t, 1.35);
    const double needles = 0.004 * t * std::cos(2 * pi * (7 * t + 1.5 * lobe));
    return around_axis(r, std::lerp(tier.top, tier.edge, fall) + 0.035 * lobe * t + needles,
                       2 * pi * turn);
}

Mesh make_tier(int i) {
    constexpr int kColumns = 216, kRows = 40, kRowsBelow = 4;
    const auto above = [&](double a, double b) {
        return PatchPoint{bough_point(i, a, b), {kTreeRepeats * a, bough_row(i, b)}};
    };
    const Tier shape = tier_of(i);
    const auto below = [&](double a, double b) {
        const Vec3d edge = bough_point(i, a, 1);
        const double r = std::lerp(std::hypot(edge.x, edge.z), 0.3 * shape.edge_radius, b);
        return PatchPoint{around_axis(r, std::lerp(edge.y, shape.edge + 0.06, b), 2 * pi * a),
                          {kTreeRepeats * a, bough_row(i, 1 - 0.5 * b)}};
    };
    Mesh tier = tessellate(kColumns, kRows, above, cell_step(kColumns, kRows));
    append_mesh(tier, tessellate(kColumns, kRowsBelow, below, cell_step(kColumns, kRowsBelow)));
    return tier;
}

/// Radius of the cone through the edges of the tiers.
double envelope(double y) { return 0.335 + 0.51 * (1.55 - y); }

Mesh make_ribbon() {
    constexpr double kTurns = 4.25, kTop = 1.80, kBottom = 0.42;
    return tessellate(860, 4, [](double a, double b) {
        const double turn = kTurns * std::pow(a + 0.002, 0.62);
        const double middle = std::lerp(kTop, kBottom, a) + 0.022 * std::cos(2 * pi * 9 * turn);
        const double y = middle + 0.045 * (0.5 - b);
        const double r = envelope(middle) + 0.012 * std::cos(pi * (b - 0.5));
        const double v = std::lerp(kBoughsEnd, kRibbonEnd, kInset + (1 - 2 * kInset) * b);
        return PatchPoint{around_axis(r, y, 2 * pi * turn), {30 * a, v}};
    });
}

/// Coordinates within a tile; x and y in [0, 1].
Vec2<double> in_tile(int tile, double x, double y) {
    const auto inset = [](double t) { return kInset + (1 - 2 * kInset) * t; };
    return {(tile % kTiles + inset(x)) * kTileSize,
            kRibbonEnd + (tile / kTiles % kTileRows + inset(y)) * kTileSize};
}

/// A ball with a cap; the tile is shown twice around it, the second time mirrored.
Mesh make_bauble(const Vec3d& center, double radius, int tile, double turned_by) {
    return tessellate(28, 18, [&](double a, double b) {
        const double height = std::cos(pi * b), r = radius * std::sin(pi * b);
        const Vec3d p = around_axis(b == 1 ? 0 : r, radius * height, 2 * pi * (a + turned_by));
        return PatchPoint{center + p, in_tile(tile, std::fabs(2 * a - 1), b)};
    });
}

Mesh make_baubles(std::uint32_t seed) {
    Mesh baubles;
    int tile = 0;
    for (int i = 0; i < kTiers; ++i) {
        const int count = kTreeRepeats * boughs_of(i);
        for (int j = 0; j < count; ++j) {
            const auto u = uniforms({seed, Stream::kScene}, static_cast<std::uint32_t>(j),
                                    static_cast<std::uint32_t>(i), 1000);
            const double radius = 0.045 + 0.006 * i + 0.012 * static_cast<double>(u[0]);
            const Vec3d tip = bough_point(i, (j + 0.5 * (j % 2)) / count, 1.0);
            const double outside = 1 + 0.45 * radius / std::hypot(tip.x, tip.z);
            const Vec3d center{tip.x * outside, tip.y - 0.8 * radius, tip.z * outside};
            append_mesh(baubles, make_bauble(center, radius, tile, static_cast<double>(u[1])));
            tile = (tile + 5) % (kTiles * kTileRows);
        }
    }
    return baubles;
}

/// A box on the floor: six faces, each a tile.
Mesh make_box(const Vec3d& middle, const Vec3d& half, double turn, int tile) {
    Mesh box;
    const Vec3d x = around_axis(half.x, 0, turn + pi / 2), z = around_axis(half.z, 0, turn);
    const Vec3d y{0, half.y, 0};
    struct Side {
        Vec3d out, right, down;
    };
    const Side sides[] = {{y, x, z},    {-y, x, -z}, {z, x, -y},
                          {-z, -x, -y}, {x, -z, -y}, {-x, z, -y}};
    for (const Side& side : sides) {
        append_mesh(box, tessellate(2, 2, [&](double a, double b) {
                        return PatchPoint{
                            middle + side.out + side.right * (2 * a - 1) + side.down * (2 * b - 1),
                            in_tile(tile, a, b)};
                    }));
    }
    return box;
}

}  // namespace

double bough_row(int tier, double t) {
    // Rows in proportion to 2, 3, 4, 5, 6: lower tiers are larger.
    const double before = tier * (tier + 3) / 2.0;
    return kBoughsEnd * (before + (tier + 2) * std::clamp(t, 0.003, 0.997)) / 20.0;
}

TreePlace tree_place(int tier, double turn, double t) {
    const double step = 1e-4;
    const Vec3d da = bough_point(tier, turn + step, t) - bough_point(tier, turn - step, t);
    const Vec3d db = bough_point(tier, turn, t + step) - bough_point(tier, turn, t - step);
    return {bough_point(tier, turn, t), normalize(cross(db, da))};
}

Mesh make_tree(std::uint32_t seed) {
    Mesh tree;
    for (int i = 0; i < kTiers; ++i) append_mesh(tree, make_tier(i));
    append_mesh(tree, make_ribbon());
    append_mesh(tree, make_baubles(seed));
    append_mesh(tree, make_box({-0.62, 0.14, 0.72}, {0.19, 0.14, 0.15}, 0.45, 1));
    append_mesh(tree, make_box({-0.27, 0.085, 0.98}, {0.12, 0.085, 0.12}, -0.30, 12));
    append_mesh(tree, make_box({0.58, 0.11, 0.82}, {0.22, 0.11, 0.16}, -0.55, 18));
    append_mesh(tree, make_box({0.90, 0.17, 0.42}, {0.14, 0.17, 0.14}, 0.25, 7));
    return tree;
}

Mesh make_trunk() {
    constexpr Vec2<double> kPot[] = {{0.09, 0.60}, {0.10, 0.40}, {0.11, 0.27},  {0.20, 0.265},
                                     {0.25, 0.27}, {0.26, 0.24}, {0.235, 0.12}, {0.20, 0.00}};
    return make_turned(kPot, 64, 28);
}

Mesh make_star() {
    Mesh star;
    const auto corner = [](int i) {
        const double r = i % 2 ? 0.42 : 1.0, angle = pi * i / 5;
        return Vec3d{r * std::sin(angle), r * std::cos(angle), 0};
    };
    for (int i = 0; i < 10; ++i) {
        add_flat_triangle(star, {0, 0, 0.28}, corner(i + 1), corner(i));
        add_flat_triangle(star, {0, 0, -0.28}, corner(i), corner(i + 1));
    }
    return star;
}

Mesh make_bulb() {
    Mesh bulb;
    for (int i = 0; i < 6; ++i) {
        const Vec3d a = around_axis(0.9, -0.25, pi * i / 3);
        const Vec3d b = around_axis(0.9, -0.25, pi * (i + 1) / 3);
        add_flat_triangle(bulb, {0, 1.5, 0}, a, b);
        add_flat_triangle(bulb, {0, -1, 0}, b, a);
    }
    return bulb;
}

}  // namespace burnish::procedural
