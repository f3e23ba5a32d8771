#include "texture/charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "shading/texture.h"

namespace burnish {

namespace {

/// Disjoint sets; the least member names a set.
struct DisjointSets {
    std::vector<std::uint32_t> parent;

    std::uint32_t find(std::uint32_t i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    }
    void unite(std::uint32_t a, std::uint32_t b) {
        a = find(a), b = find(b);
        parent[std::max(a, b)] = std::min(a, b);
    }
};

/// A triangle in units of texels: texel (x, y) has its centre at (x + 1/2, y + 1/2).
struct UvTriangle {
    std::array<Vec2f, 3> corner;
    std::uint32_t vertex = 0;  ///< one of its vertices, by which its set is found
};

struct UvMeshes {
    std::vector<UvTriangle> triangles;
    DisjointSets sets;  ///< of vertices
};

/// Vertices of a mesh that are equal in position and texture coordinate become one set.
void unite_equal_vertices(const Mesh& mesh, std::uint32_t first, DisjointSets& sets) {
    using Key = std::array<float, 5>;
    const auto key = [&](std::uint32_t i) {
        const Vec3f& p = mesh.positions[i];
        return Key{p.x, p.y, p.z, mesh.uvs[i].x, mesh.uvs[i].y};
    };
    std::vector<std::uint32_t> order(mesh.positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const Key ka = key(a), kb = key(b);
        return ka != kb ? ka < kb : a < b;
    });
    for (std::size_t i = 1; i < order.size(); ++i)
        if (key(order[i - 1]) == key(order[i])) sets.unite(first + order[i - 1], first + order[i]);
}

void add_mesh(const Mesh& mesh, const Bitmap& bitmap, UvMeshes& all) {
    const auto first = static_cast<std::uint32_t>(all.sets.parent.size());
    all.sets.parent.resize(first + mesh.positions.size());
    std::iota(all.sets.parent.begin() + first, all.sets.parent.end(), first);
    unite_equal_vertices(mesh, first, all.sets);
    const auto texels = [&](std::uint32_t vertex) {
        const Vec2f uv = transform_uv(bitmap.to_uv, mesh.uvs[vertex]);
        return Vec2f{uv.x * static_cast<float>(bitmap.width),
                     uv.y * static_cast<float>(bitmap.height)};
    };
    for (const Triangle& t : mesh.triangles) {
        all.sets.unite(first + t.vertex[0], first + t.vertex[1]);
        all.sets.unite(first + t.vertex[0], first + t.vertex[2]);
        all.triangles.push_back(
            {{texels(t.vertex[0]), texels(t.vertex[1]), texels(t.vertex[2])}, first + t.vertex[0]});
    }
}

struct Interval {
    float low = std::numeric_limits<float>::infinity(), high = -low;

    void include(float v) { low = std::min(low, v), high = std::max(high, v); }
};

/// The part of a triangle's outline, and so of the triangle, between two heights: its extent in x.
Interval extent_between(const UvTriangle& t, float y0, float y1) {
    Interval extent;
    for (std::size_t i = 0; i < 3; ++i) {
        Vec2f a = t.corner[i], b = t.corner[(i + 1) % 3];
        if (a.y > b.y) std::swap(a, b);
        if (b.y < y0 || a.y > y1) continue;
        const auto at = [&](float y) { return a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)); };
        extent.include(a.y < y0 ? at(y0) : a.x);
        extent.include(b.y > y1 ? at(y1) : b.x);
    }
    return extent;
}

Interval height_of(const UvTriangle& t) {
    Interval height;
    for (const Vec2f& c : t.corner) height.include(c.y);
    return height;
}

int wrapped(int i, int size, TextureWrap wrap) {
    if (i >= 0 && i < size) return i;
    switch (wrap) {
        case TextureWrap::kRepeat:
            return ((i % size) + size) % size;
        case TextureWrap::kMirror: {
            const int j = ((i % (2 * size)) + 2 * size) % (2 * size);
            return j < size ? j : 2 * size - 1 - j;
        }
        case TextureWrap::kClamp:
            break;
    }
    return std::clamp(i, 0, size - 1);
}

/// Calls body(texel) for the texels, wrapped, around whose centre the square of half a side `half`
/// meets the triangle.
template <class Body>
void for_texels(const Bitmap& bitmap, const UvTriangle& t, float half, const Body& body) {
    // The first and the last whose centre is at most `half` outside.
    const auto first = [&](float low) { return static_cast<int>(std::ceil(low - half - 0.5f)); };
    const auto last = [&](float high) { return static_cast<int>(std::floor(high + half - 0.5f)); };
    const Interval height = height_of(t);
    for (int y = first(height.low); y <= last(height.high); ++y) {
        const float centre = static_cast<float>(y) + 0.5f;
        const Interval extent = extent_between(t, centre - half, centre + half);
        if (!(extent.low <= extent.high)) continue;
        const auto row = static_cast<std::size_t>(wrapped(y, bitmap.height, bitmap.wrap)) *
                         static_cast<std::size_t>(bitmap.width);
        for (int x = first(extent.low); x <= last(extent.high); ++x)
            body(row + static_cast<std::size_t>(wrapped(x, bitmap.width, bitmap.wrap)));
    }
}

/// Texels that for_texels visits, or a few more.
double area_of(const UvTriangle& t) {
    const auto& c = t.corner;
    const Interval height = height_of(t);
    Interval width;
    for (const Vec2f& p : c) width.include(p.x);
    const double wide = double{width.high} - double{width.low},
                 high = double{height.high} - double{height.low};
    const double twice = (double{c[1].x} - double{c[0].x}) * (double{c[2].y} - double{c[0].y}) -
                         (double{c[1].y} - double{c[0].y}) * (double{c[2].x} - double{c[0].x});
    return std::abs(twice) / 2 + 4 * (wide + high) + 16;
}

/// The meshes that read the bitmap; nothing where a shape without its own texture coordinates does,
/// or where it repeats too often.
UvMeshes meshes_of(const Scene& scene, TextureId texture, const Bitmap& bitmap) {
    UvMeshes all;
    std::set<const Mesh*> known;  // several instances may show one
    for (const Shape& shape : scene.shapes) {
        const std::vector<TextureId> read = textures_of(scene, shape.material);
        if (std::find(read.begin(), read.end(), texture) == read.end()) continue;
        const Mesh* mesh = shown_mesh(scene, shape);
        if (!mesh || mesh->uvs.empty()) return {};
        if (!known.insert(mesh).second) continue;
        add_mesh(*mesh, bitmap, all);
    }
    constexpr double kMaxRepetitions = 16;
    double area = 0;
    for (const UvTriangle& t : all.triangles) {
        for (const Vec2f& c : t.corner)
            if (!(std::abs(c.x) < 1e8f && std::abs(c.y) < 1e8f)) return {};
        area += area_of(t);
    }
    const double min = 16.0 * static_cast<double>(all.triangles.size());
    if (area > min + kMaxRepetitions * bitmap.width * bitmap.height) return {};
    return all;
}

}  // namespace

ChartMap texture_charts(const Scene& scene, TextureId texture) {
    const auto& bitmap = std::get<Bitmap>(scene[texture]);
    const auto texels =
        static_cast<std::size_t>(bitmap.width) * static_cast<std::size_t>(bitmap.height);
    if (texels == 1) return {1};
    UvMeshes all = meshes_of(scene, texture, bitmap);
    if (all.triangles.empty()) return ChartMap(texels, 1);

    constexpr auto kNone = static_cast<std::uint32_t>(-1);
    ChartMap owner(texels, kNone);
    for (const UvTriangle& t : all.triangles)
        for_texels(bitmap, t, 0.0f, [&](std::size_t i) {
            if (owner[i] != kNone) all.sets.unite(owner[i], t.vertex);
            owner[i] = t.vertex;
        });
    constexpr float kReach = 1 + 1.0f / 64;  // of a look-up, with its rounding
    for (const UvTriangle& t : all.triangles)
        for_texels(bitmap, t, kReach, [&](std::size_t i) {
            if (owner[i] == kNone) owner[i] = t.vertex;
        });

    std::vector<std::uint32_t> number(all.sets.parent.size(), 0);
    std::uint32_t charts = 0;
    for (std::uint32_t& o : owner) {
        if (o == kNone) {
            o = 0;
            continue;
        }
        std::uint32_t& n = number[all.sets.find(o)];
        if (n == 0) n = ++charts;
        o = n;
    }
    return owner;
}

}  // namespace burnish
