#include "cli/mesh_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/vec.h"
#include "mitsuba/mesh.h"
#include "paths/surface.h"
#include "shading/texture.h"

namespace burnish {

namespace {

/// Twice the signed area of a triangle of the plane.
double twice_area(const Vec2<double>& a, const Vec2<double>& b, const Vec2<double>& c) {
    return (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
}

using UvTriangle = std::array<Vec2<double>, 3>;

/// In texels, counterclockwise.
UvTriangle uv_triangle(const Mesh& mesh, const Triangle& t, const UvTransform& to_uv, int width,
                       int height) {
    UvTriangle uv;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec2f p = transform_uv(to_uv, mesh.uvs[t.vertex[i]]);
        uv[i] = {double{p.x} * width, double{p.y} * height};
    }
    if (twice_area(uv[0], uv[1], uv[2]) < 0) std::swap(uv[1], uv[2]);
    return uv;
}

/// Whether a point lies within. One that lies on an edge belongs to one of the two triangles beside
/// it.
bool contains(const UvTriangle& t, const Vec2<double>& p) {
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec2<double>&a = t[i], &b = t[(i + 1) % 3];
        const double side = twice_area(a, b, p);
        const bool owns = b.y > a.y || (b.y == a.y && b.x < a.x);
        if (side < 0 || (side == 0 && !owns)) return false;
    }
    return true;
}

struct Span {
    double low, high;
};

/// Where a row strictly between a triangle's lowest and highest corner lies within it, but for
/// rounding; low above high: nowhere.
Span span_of(const UvTriangle& t, double y) {
    Span span{-INFINITY, INFINITY};
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec2<double>&a = t[i], &b = t[(i + 1) % 3];
        if (a.y == b.y) continue;
        const double x = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
        if (b.y > a.y) span.high = std::min(span.high, x);
        if (b.y < a.y) span.low = std::max(span.low, x);
    }
    return span;
}

/// The texels that fewer than two triangles cover, found without a look at the others: where many
/// faces share one part of the texture, each texel is raised twice and passed over from then on.
struct OpenTexels {
    UvCovers& covers;
    std::size_t left = 0;        ///< how many there are
    std::vector<int> next = {};  ///< [height, width + 1]: a column at or before the row's next one
};

OpenTexels open_texels(UvCovers& covers) {
    OpenTexels open{covers};
    open.next.reserve(covers.count.size() + static_cast<std::size_t>(covers.height));
    auto count = covers.count.begin();
    for (int y = 0; y < covers.height; ++y) {
        for (int x = 0; x < covers.width; ++x, ++count) {
            open.next.push_back(*count < 2 ? x : x + 1);
            open.left += *count < 2;
        }
        open.next.push_back(covers.width);
    }
    return open;
}

/// One row of them.
struct OpenRow {
    unsigned char* count;
    int* next;
    int width;
};

OpenRow row_of(OpenTexels& open, int y) {
    const auto width = static_cast<std::size_t>(open.covers.width),
               row = static_cast<std::size_t>(y);
    return {open.covers.count.data() + row * width, open.next.data() + row * (width + 1),
            open.covers.width};
}

/// The first open column from one on; the width: there is none. Shortens the way there.
int next_open(const OpenRow& row, int column) {
    while (row.next[column] != column) column = row.next[column] = row.next[row.next[column]];
    return column;
}

/// Of an open texel that a triangle covers.
void raise(const OpenRow& row, int column, OpenTexels& open) {
    if (++row.count[column] < 2) return;
    row.next[column] = column + 1;
    --open.left;
}

void raise_all(OpenTexels& open) {
    for (int y = 0; y < open.covers.height; ++y) {
        const OpenRow row = row_of(open, y);
        for (int x = next_open(row, 0); x < row.width; x = next_open(row, x + 1))
            raise(row, x, open);
    }
}

/// The triangle in texels.
void add_triangle(const UvTriangle& t, OpenTexels& open) {
    if (!(twice_area(t[0], t[1], t[2]) > 0)) return;
    const int width = open.covers.width, height = open.covers.height;
    const auto wrapped = [](int i, int size) { return ((i % size) + size) % size; };
    const auto [x0, x1] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [y0, y1] = std::minmax({t[0].y, t[1].y, t[2].y});
    constexpr double kMax = 1e9, kRounding = 1e-3;  // of numbers of texels
    if (!(y1 - y0 <= 2 * height && -x0 < kMax && x1 < kMax && -y0 < kMax && y1 < kMax))
        return raise_all(open);
    const int top = static_cast<int>(std::ceil(y0 - 0.5));
    for (int y = top; y + 0.5 <= y1; ++y) {
        const OpenRow row = row_of(open, wrapped(y, height));
        if (next_open(row, 0) == width) continue;
        const Span span = span_of(t, y + 0.5);
        const int first =
            static_cast<int>(std::ceil(std::clamp(span.low - kRounding, x0, x1) - 0.5));
        int last = static_cast<int>(std::floor(std::clamp(span.high + kRounding, x0, x1) - 0.5));
        last = std::min(last, first + 2 * width + 3);  // by then each column is covered twice
        for (int x = first; x <= last;) {
            const int column = wrapped(x, width), found = next_open(row, column);
            x += found - column;
            if (found == width) continue;                        // where the texture repeats
            const bool inside = y0 < y + 0.5 && y + 0.5 < y1 &&  // an edge there has one owner
                                x + 0.5 > span.low + kRounding && x + 0.5 < span.high - kRounding;
            if (x <= last && (inside || contains(t, {x + 0.5, y + 0.5}))) raise(row, found, open);
            ++x;
        }
    }
}

bool is_closed(const Mesh& mesh) {
    const std::vector<std::uint32_t> place = mitsuba::places_of(mesh);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> forward, backward;
    for (const Triangle& t : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = place[t.vertex[i]], b = place[t.vertex[(i + 1) % 3]];
            if (a == b) continue;
            forward.emplace_back(a, b);
            backward.emplace_back(b, a);
        }
    std::sort(forward.begin(), forward.end());
    std::sort(backward.begin(), backward.end());
    return forward == backward;
}

/// Of the sides of triangles, one by one.
void check_triangles(const Mesh& mesh, MeshCheck& check) {
    for (const Triangle& t : mesh.triangles) {
        const auto corner = [&](std::size_t i) { return to_double(mesh.positions[t.vertex[i]]); };
        const Vec3<double> a = corner(0), b = corner(1), c = corner(2);
        const Vec3<double> normal = cross(b - a, c - a);
        check.volume += dot(a, cross(b, c)) / 6;
        if (!(length(normal) > 0)) {
            ++check.without_area;
            continue;
        }
        bool turned = !mesh.normals.empty(), outside = false;
        for (const std::uint32_t v : t.vertex) {
            if (!mesh.normals.empty()) turned &= dot(normal, to_double(mesh.normals[v])) < 0;
            if (mesh.uvs.empty()) continue;
            const Vec2f& uv = mesh.uvs[v];
            outside |= !(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1);
        }
        check.turned_normals += turned;
        check.outside += outside;
        if (mesh.uvs.empty()) continue;
        const UvTriangle uv = uv_triangle(mesh, t, {}, 1, 1);
        check.without_uv_area += !(twice_area(uv[0], uv[1], uv[2]) > 0);
    }
}

/// The largest magnitude of a coordinate of its corners.
float farthest(const Box& box) {
    float far = 0;
    for (const Vec3f& p : {box.low, box.high})
        far = std::max({far, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    return far;
}

double extent_of(const Box& box) {
    const Vec3<double> d = to_double(box.size());
    return std::max({d.x, d.y, d.z});
}

double share_of(std::size_t part, const MeshCheck& check) {
    return static_cast<double>(part) / static_cast<double>(check.triangles);
}

}  // namespace

UvCovers make_covers(int width, int height) {
    return {width, height,
            std::vector<unsigned char>(static_cast<std::size_t>(width) *
                                       static_cast<std::size_t>(height))};
}

void add_covers(const Mesh& mesh, const UvTransform& to_uv, UvCovers& covers) {
    OpenTexels open = open_texels(covers);
    for (const Triangle& triangle : mesh.triangles) {
        if (open.left == 0) return;
        add_triangle(uv_triangle(mesh, triangle, to_uv, covers.width, covers.height), open);
    }
}

CoveredShares shares_of(const UvCovers& covers) {
    std::size_t used = 0, overlapping = 0;
    for (const unsigned char count : covers.count) used += count > 0, overlapping += count > 1;
    return {static_cast<double>(used) / static_cast<double>(covers.count.size()),
            used > 0 ? static_cast<double>(overlapping) / static_cast<double>(used) : 0};
}

std::string complaint_of_place(const Box& box) {
    constexpr double kMax = 0.01;  // of its size: corners and contact shadows are seen to change
    const double far = double{farthest(box)}, extent = extent_of(box);
    const double offset = double{kRayOffset} * (1 + far);
    if (!(extent > 0 && offset > kMax * extent)) return {};
    if (far < 1)
        return fmt::format(
            "is {:.3g} units large, and rays begin {:.2g} off its surface: scale the scene up",
            extent, offset);
    return fmt::format(
        "lies {:.0f} times its own size from the origin, where rays begin up to {:.2g} off its "
        "surface: move it, and the cameras, to the origin",
        far / extent, offset);
}

MeshCheck check_mesh(const Mesh& mesh, int texture_size) {
    MeshCheck check;
    check.triangles = mesh.triangles.size();
    for (const Vec3f& p : mesh.positions) check.box.include(p);
    check_triangles(mesh, check);
    check.is_closed = is_closed(mesh);
    if (mesh.uvs.empty()) return check;
    UvCovers covers = make_covers(texture_size, texture_size);
    add_covers(mesh, {}, covers);
    const CoveredShares shares = shares_of(covers);
    check.used_share = shares.used, check.overlapping_share = shares.overlapping;
    return check;
}

std::vector<std::string> complaints(const MeshCheck& check) {
    std::vector<std::string> all;
    constexpr double kFew = 0.001;  // of texels or triangles: rounding, or not worth a sentence
    constexpr double kLittle = 0.01;
    if (check.overlapping_share > kFew)
        all.push_back(fmt::format(
            "{:.1f} % of the used texels are read by several places of the surface, which get one "
            "value together: unwrap the mesh without overlaps if they differ",
            100 * check.overlapping_share));
    if (share_of(check.without_uv_area, check) > kFew)
        all.push_back(fmt::format("{} of {} triangles have no area in the texture: unwrap them",
                                  check.without_uv_area, check.triangles));
    if (check.outside == 0 && check.used_share < kLittle &&
        check.without_area + check.without_uv_area < check.triangles)
        all.push_back(fmt::format(
            "all charts together lie on {:.2g} % of the texture: let them fill the unit square",
            100 * check.used_share));
    if (check.outside > 0)
        all.push_back(fmt::format(
            "{} of {} triangles leave the unit square of the texture, which repeats there",
            check.outside, check.triangles));
    if (share_of(check.turned_normals, check) > kFew)
        all.push_back(fmt::format(
            "{} of {} triangles have normals that look to their back: recompute the normals",
            check.turned_normals, check.triangles));
    if (check.is_closed && check.volume < 0)
        all.push_back("the faces of this closed mesh look inwards and stay black: flip them");
    if (share_of(check.without_area, check) > kFew)
        all.push_back(
            fmt::format("{} of {} triangles have no area", check.without_area, check.triangles));
    if (const double extent = extent_of(check.box); extent > 1e4)
        all.push_back(fmt::format(
            "the mesh is {:.3g} units large: expected at most 10000, scale it", extent));
    if (const std::string text = complaint_of_place(check.box); !text.empty())
        all.push_back("the mesh " + text);
    return all;
}

}  // namespace burnish
