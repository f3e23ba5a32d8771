#include "render/visible_pixels.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "render/lens_pixels.h"

namespace burnish {

namespace {

/// Pixels by which a projection is enlarged: far above its rounding.
constexpr double kMargin = 1.0 / 64;

using Point = Vec3<double>;

Point divided(const Point& p) { return {p.x / p.z, p.y / p.z, p.z}; }

/// World -> (film x z, film y z, z) in pixels of the crop window, z along the camera's axis; of an
/// orthographic camera, which has no way to the eye, z stays 1.
class Projection {
  public:
    explicit Projection(const TracedScene& view) : eye_(to_double(view.camera.eye)) {
        const CameraRays& c = view.camera;
        const Film& film = view.film;
        const Point across = to_double(c.across), down = to_double(c.down),
                    corner = to_double(c.corner);
        const double across2 = length_squared(across), down2 = length_squared(down);
        const double corner_x = dot(corner, across) / across2;
        const double corner_y = dot(corner, down) / down2;
        const double left = corner_x * film.width + film.crop_x;
        const double top = corner_y * film.height + film.crop_y;
        x_.normal = across * (film.width / across2), y_.normal = down * (film.height / down2);
        if (c.kind == CameraKind::kOrthographic) {
            x_.constant = -left, y_.constant = -top, z_.constant = 1;
            return;
        }
        z_.normal = corner - across * corner_x - down * corner_y;
        x_.normal = x_.normal - z_.normal * left;
        y_.normal = y_.normal - z_.normal * top;
    }

    Point operator()(const Vec3f& world) const {
        const Point v = to_double(world) - eye_;
        return {x_(v), y_(v), z_(v)};
    }

  private:
    struct Affine {
        Point normal;
        double constant = 0;

        double operator()(const Point& v) const { return dot(normal, v) + constant; }
    };

    Point eye_;
    Affine x_, y_, z_;
};

/// A corner before and after the division by z.
struct Corner {
    Point along, on_film;
};

/// A triangle of which a plane may have cut off a corner.
struct Polygon {
    std::array<Point, 4> corners;
    std::size_t count = 0;

    std::span<const Point> points() const { return std::span(corners).first(count); }
};

/// The part of a triangle that lies beyond the plane z = least, divided by z.
Polygon clip(const std::array<const Corner*, 3>& triangle, double min) {
    Polygon result;
    const auto add = [&](const Point& on_film) { result.corners[result.count++] = on_film; };
    for (std::size_t i = 0; i < triangle.size(); ++i) {
        const Point &a = triangle[i]->along, &b = triangle[(i + 1) % triangle.size()]->along;
        if (a.z >= min) add(triangle[i]->on_film);
        if ((a.z >= min) == (b.z >= min)) continue;
        const double t = (min - a.z) / (b.z - a.z);
        add(divided({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), min}));
    }
    return result;
}

/// Pixels, which several threads may mark.
struct Canvas {
    int width = 0, height = 0;
    std::vector<char> pixels;

    char* row(int y) {
        return &pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)];
    }
    void mark_row(int y, int first, int last) {
        for (int x = first; x <= last; ++x)
            std::atomic_ref(row(y)[x]).store(1, std::memory_order_relaxed);
    }
    /// Whether each pixel of a rectangle is marked; its last row and column count, too.
    bool is_marked(int x0, int x1, int y0, int y1) {
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x)
                if (!std::atomic_ref(row(y)[x]).load(std::memory_order_relaxed)) return false;
        return true;
    }
};

/// A side of a polygon: x at any y of it.
struct Side {
    double top = 0, bottom = 0;
    Point from;
    double slope = 0;

    Side() = default;
    Side(const Point& a, const Point& b)
        : top(std::min(a.y, b.y)),
          bottom(std::max(a.y, b.y)),
          from(a),
          slope(a.y == b.y ? 0 : (b.x - a.x) / (b.y - a.y)) {}

    double x_at(double y) const { return from.x + (std::clamp(y, top, bottom) - from.y) * slope; }
};

struct Extent {
    double min = 0, max = 0;
};
Extent extent_of(std::span<const Point> points, double Point::*axis) {
    Extent e{points[0].*axis, points[0].*axis};
    for (const Point& p : points)
        e.min = std::min(e.min, p.*axis), e.max = std::max(e.max, p.*axis);
    return e;
}

/// Marks every pixel that a convex polygon touches: row by row, the extent of the polygon within
/// the row. Most pixels around a small one are marked by others.
void mark(std::span<const Point> polygon, Canvas& canvas) {
    if (polygon.empty()) return;
    const auto pixel = [](double x, int size) {
        return static_cast<int>(std::clamp(std::floor(x), -1.0, static_cast<double>(size)));
    };
    const auto [top, bottom] = extent_of(polygon, &Point::y);
    const int first = std::max(0, pixel(top - kMargin, canvas.height));
    const int last = std::min(canvas.height - 1, pixel(bottom + kMargin, canvas.height));
    const auto [left, right] = extent_of(polygon, &Point::x);
    const int from_x = pixel(left - kMargin, canvas.width);
    const int to_x = pixel(right + kMargin, canvas.width);
    const int first_x = std::max(0, from_x), last_x = std::min(canvas.width - 1, to_x);
    if (from_x == to_x || first == last) {
        for (int y = first; y <= last; ++y) canvas.mark_row(y, first_x, last_x);
        return;
    }
    if (canvas.is_marked(first_x, last_x, first, last)) return;
    std::array<Side, 4> sides;
    for (std::size_t i = 0; i < polygon.size(); ++i)
        sides[i] = Side(polygon[i], polygon[(i + 1) % polygon.size()]);
    for (int y = first; y <= last; ++y) {
        const double y0 = y - kMargin, y1 = y + 1 + kMargin;
        double from = std::numeric_limits<double>::infinity(), to = -from;
        for (const Side& side : std::span(sides).first(polygon.size())) {
            if (side.bottom < y0 || side.top > y1) continue;
            for (const double x : {side.x_at(y0), side.x_at(y1)})
                from = std::min(from, x), to = std::max(to, x);
        }
        canvas.mark_row(y, std::max(0, pixel(from - kMargin, canvas.width)),
                        std::min(canvas.width - 1, pixel(to + kMargin, canvas.width)));
    }
}

/// Calls body(c0, c1, c2) for triangles that enclose the shape, with the corners of what `corner`
/// makes of positions; those of a mesh in parallel.
void for_triangles_of(const Scene&, const Mesh& mesh, const auto& corner, const auto& body) {
    constexpr std::size_t kChunk = 4096;
    std::vector<Corner> corners(mesh.positions.size());
    parallel_chunks(corners.size(), kChunk, [&](std::size_t i, std::size_t end) {
        for (; i < end; ++i) corners[i] = corner(mesh.positions[i]);
    });
    parallel_chunks(mesh.triangles.size(), kChunk, [&](std::size_t i, std::size_t end) {
        for (; i < end; ++i) {
            const std::array<std::uint32_t, 3>& v = mesh.triangles[i].vertex;
            body(corners[v[0]], corners[v[1]], corners[v[2]]);
        }
    });
}

/// The faces of a box.
void for_triangles_of(const Box& box, const auto& corner_of, const auto& body) {
    for (int axis = 0; axis < 3; ++axis)
        for (const Vec3f& side : {box.low, box.high}) {
            const int next = (axis + 1) % 3, last = (axis + 2) % 3;
            const auto corner = [&](bool a, bool b) {
                Vec3f p = side;
                p[next] = a ? box.high[next] : box.low[next];
                p[last] = b ? box.high[last] : box.low[last];
                return corner_of(p);
            };
            body(corner(false, false), corner(true, false), corner(true, true));
            body(corner(false, false), corner(true, true), corner(false, true));
        }
}

void for_triangles_of(const Scene&, const Cylinder& cylinder, const auto& corner,
                      const auto& body) {
    for_triangles_of(box_of(cylinder), corner, body);
}

/// The square around it.
void for_triangles_of(const Scene&, const Disk& disk, const auto& corner_of, const auto& body) {
    const auto corner = [&](float x, float y) {
        return corner_of(transform_point(disk.to_world, {x, y, 0}));
    };
    body(corner(-1, -1), corner(1, -1), corner(1, 1));
    body(corner(-1, -1), corner(1, 1), corner(-1, 1));
}

/// The faces of the cube around it.
void for_triangles_of(const Scene&, const Sphere& sphere, const auto& corner, const auto& body) {
    for_triangles_of(box_of(sphere), corner, body);
}

/// Those around the prototype, moved with it.
void for_triangles_of(const Scene& scene, const Instance& instance, const auto& corner,
                      const auto& body) {
    const auto moved = [&](const Vec3f& p) {
        return corner(transform_point(instance.to_world, p));
    };
    const Geometry& geometry = scene.prototypes[instance.prototype].geometry;
    if (const Mesh* mesh = mesh_of(geometry))
        for_triangles_of(scene, *mesh, moved, body);
    else
        for_triangles_of(box_of(geometry), moved, body);
}

/// Of a pinhole or an orthographic camera.
std::vector<char> projected(const TracedScene& view, std::span<const char> bsdfs) {
    const Scene& scene = *view.scene;
    const Film& film = view.film;
    Canvas canvas{film.crop_width, film.crop_height, {}};
    canvas.pixels.assign(static_cast<std::size_t>(pixels_of(film)), 0);
    const Projection project(view);
    const bool parallel = view.camera.kind == CameraKind::kOrthographic;
    const double min = parallel ? 0 : 0.5 * double{view.camera.near_clip};
    const auto asked = [&](BsdfId id) { return bsdfs[static_cast<std::size_t>(id.value)] != 0; };
    const auto corner = [&](const Vec3f& world) {
        const Point along = project(world);
        return Corner{along, divided(along)};
    };
    const auto mark_triangle = [&](const Corner& a, const Corner& b, const Corner& c) {
        mark(clip({&a, &b, &c}, min).points(), canvas);
    };
    for (const Shape& shape : scene.shapes) {
        const auto shown = bsdfs_of(scene, shape.material);
        if (std::none_of(shown.begin(), shown.end(), asked)) continue;
        std::visit([&](const auto& g) { for_triangles_of(scene, g, corner, mark_triangle); },
                   shape.geometry);
    }
    return canvas.pixels;
}

std::vector<char> all_pixels(const Film& film) {
    return std::vector<char>(static_cast<std::size_t>(pixels_of(film)), 1);
}

}  // namespace

std::vector<char> reaching_pixels(const TracedScene& view, std::span<const char> bsdfs) {
    return has_bounces(*view.scene) ? all_pixels(view.film) : visible_pixels(view, bsdfs);
}

std::vector<char> visible_pixels(const TracedScene& view, std::span<const char> bsdfs) {
    if (has_aperture(view.camera)) return all_pixels(view.film);
    if (!has_lens(view.camera)) return projected(view, bsdfs);
    return visible_through_lens(
        view, [&](const TracedScene& pinhole) { return projected(pinhole, bsdfs); });
}

std::vector<char> dilate(const std::vector<char>& pixels, int width, int height, int reach) {
    const auto size = static_cast<std::size_t>(width);
    std::vector<char> rows(pixels.size(), 0), result(pixels.size(), 0);
    const auto row_of = [size](auto& image, int y) {
        return &image[static_cast<std::size_t>(y) * size];
    };
    const auto add = [](const char* __restrict from, std::size_t count, char* __restrict to) {
        for (std::size_t x = 0; x < count; ++x) to[x] |= from[x];
    };
    const int across = std::min(reach, width - 1);
    for (int y = 0; y < height; ++y) {
        const char* from = row_of(pixels, y);
        char* to = row_of(rows, y);
        for (int k = 0; k <= across; ++k) {
            const auto shift = static_cast<std::size_t>(k);
            add(from + shift, size - shift, to);
            add(from, size - shift, to + shift);
        }
    }
    for (int y = 0; y < height; ++y)
        for (int k = std::max(0, y - reach); k <= std::min(height - 1, y + reach); ++k)
            add(row_of(rows, k), size, row_of(result, y));
    return result;
}

}  // namespace burnish
