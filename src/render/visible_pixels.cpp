#include "render/visible_pixels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/lens_pixels.h"

namespace burnish {

namespace {

/// Pixels by which a projection is enlarged: far above its rounding.
constexpr double kMargin = 1.0 / 64;

struct Point {
    double x = 0, y = 0, z = 0;
};

/// World -> (film x z, film y z, z) in pixels of the crop window, z along the camera's axis.
class Projection {
  public:
    explicit Projection(const TracedScene& view) : film_(view.film) {
        const CameraRays& c = view.camera;
        orthographic_ = c.kind == CameraKind::kOrthographic;
        eye_ = wide(c.eye), across_ = wide(c.across), down_ = wide(c.down);
        const Point corner = wide(c.corner);
        across2_ = inner(across_, across_), down2_ = inner(down_, down_);
        corner_x_ = inner(corner, across_) / across2_, corner_y_ = inner(corner, down_) / down2_;
        forward_ = {corner.x - corner_x_ * across_.x - corner_y_ * down_.x,
                    corner.y - corner_x_ * across_.y - corner_y_ * down_.y,
                    corner.z - corner_x_ * across_.z - corner_y_ * down_.z};
    }

    Point operator()(const Vec3f& world) const {
        const Point v{world.x - eye_.x, world.y - eye_.y, world.z - eye_.z};
        const double z = inner(v, forward_);
        if (orthographic_) {  // no way to the eye: z stays 1
            const double right = inner(v, across_) / across2_ - corner_x_,
                         below = inner(v, down_) / down2_ - corner_y_;
            return {right * film_.width - film_.crop_x, below * film_.height - film_.crop_y, 1};
        }
        const double x = inner(v, across_) / across2_ - corner_x_ * z;
        const double y = inner(v, down_) / down2_ - corner_y_ * z;
        return {x * film_.width - film_.crop_x * z, y * film_.height - film_.crop_y * z, z};
    }

  private:
    static Point wide(const Vec3f& v) { return {v.x, v.y, v.z}; }
    static double inner(const Point& a, const Point& b) {
        return a.x * b.x + a.y * b.y + a.z * b.z;
    }
    Film film_;
    bool orthographic_ = false;
    Point eye_, across_, down_, forward_;
    double across2_ = 1, down2_ = 1, corner_x_ = 0, corner_y_ = 0;
};

/// A triangle of which a plane may have cut off a corner.
struct Polygon {
    std::array<Point, 4> corners;
    std::size_t count = 0;

    std::span<const Point> points() const { return std::span(corners).first(count); }
};

/// The part of a triangle that lies beyond the plane z = least, divided by z.
Polygon clip_and_project(const std::array<Point, 3>& triangle, double least) {
    Polygon result;
    const auto project = [&](const Point& p) {
        result.corners[result.count++] = {p.x / p.z, p.y / p.z, p.z};
    };
    for (std::size_t i = 0; i < triangle.size(); ++i) {
        const Point &a = triangle[i], &b = triangle[(i + 1) % triangle.size()];
        if (a.z >= least) project(a);
        if ((a.z >= least) == (b.z >= least)) continue;
        const double t = (least - a.z) / (b.z - a.z);
        project({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), least});
    }
    return result;
}

struct Canvas {
    int width = 0, height = 0;
    std::vector<char> pixels;
};

/// Marks every pixel that a convex polygon touches: row by row, the extent of the polygon within
/// the row.
void mark(std::span<const Point> polygon, Canvas& canvas) {
    if (polygon.empty()) return;
    double top = polygon[0].y, bottom = top;
    for (const Point& p : polygon) top = std::min(top, p.y), bottom = std::max(bottom, p.y);
    const auto pixel = [](double x, int size) {
        return static_cast<int>(std::clamp(std::floor(x), -1.0, static_cast<double>(size)));
    };
    const int first = std::max(0, pixel(top - kMargin, canvas.height));
    const int last = std::min(canvas.height - 1, pixel(bottom + kMargin, canvas.height));
    for (int y = first; y <= last; ++y) {
        const double y0 = y - kMargin, y1 = y + 1 + kMargin;
        double left = std::numeric_limits<double>::infinity(), right = -left;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
            if (std::max(a.y, b.y) < y0 || std::min(a.y, b.y) > y1) continue;
            for (const double edge : {std::clamp(a.y, y0, y1), std::clamp(b.y, y0, y1)}) {
                const double t = a.y == b.y ? 0 : (edge - a.y) / (b.y - a.y);
                const double x = a.x + t * (b.x - a.x);
                left = std::min(left, x), right = std::max(right, x);
            }
            if (a.y == b.y) left = std::min(left, b.x), right = std::max(right, b.x);
        }
        const int x0 = std::max(0, pixel(left - kMargin, canvas.width));
        const int x1 = std::min(canvas.width - 1, pixel(right + kMargin, canvas.width));
        for (int x = x0; x <= x1; ++x)
            canvas.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(canvas.width) +
                          static_cast<std::size_t>(x)] = 1;
    }
}

/// Calls body(p0, p1, p2) for triangles that enclose the shape.
template <class Body>
void for_triangles_of(const Scene&, const Mesh& mesh, const Body& body) {
    for (const Triangle& t : mesh.triangles)
        body(mesh.positions[t.vertex[0]], mesh.positions[t.vertex[1]], mesh.positions[t.vertex[2]]);
}

/// The faces of a box.
template <class Body>
void for_triangles_of(const Box& box, const Body& body) {
    for (int axis = 0; axis < 3; ++axis)
        for (const Vec3f& side : {box.low, box.high}) {
            const int next = (axis + 1) % 3, last = (axis + 2) % 3;
            const auto corner = [&](bool a, bool b) {
                Vec3f p = side;
                p[next] = a ? box.high[next] : box.low[next];
                p[last] = b ? box.high[last] : box.low[last];
                return p;
            };
            body(corner(false, false), corner(true, false), corner(true, true));
            body(corner(false, false), corner(true, true), corner(false, true));
        }
}

template <class Body>
void for_triangles_of(const Scene&, const Cylinder& cylinder, const Body& body) {
    for_triangles_of(box_of(cylinder), body);
}

/// The square around it.
template <class Body>
void for_triangles_of(const Scene&, const Disk& disk, const Body& body) {
    const auto corner = [&](float x, float y) { return transform_point(disk.to_world, {x, y, 0}); };
    body(corner(-1, -1), corner(1, -1), corner(1, 1));
    body(corner(-1, -1), corner(1, 1), corner(-1, 1));
}

/// The faces of the cube around it.
template <class Body>
void for_triangles_of(const Scene&, const Sphere& sphere, const Body& body) {
    for_triangles_of(box_of(sphere), body);
}

/// Those around the prototype, moved with it.
template <class Body>
void for_triangles_of(const Scene& scene, const Instance& instance, const Body& body) {
    const auto moved = [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) {
        const Transform& m = instance.to_world;
        body(transform_point(m, a), transform_point(m, b), transform_point(m, c));
    };
    const Geometry& geometry = scene.prototypes[instance.prototype].geometry;
    if (const Mesh* mesh = mesh_of(geometry))
        for_triangles_of(scene, *mesh, moved);
    else
        for_triangles_of(box_of(geometry), moved);
}

/// Of a pinhole or an orthographic camera.
std::vector<char> projected(const TracedScene& view, std::span<const char> bsdfs) {
    const Scene& scene = *view.scene;
    const Film& film = view.film;
    Canvas canvas{film.crop_width, film.crop_height, {}};
    canvas.pixels.assign(
        static_cast<std::size_t>(film.crop_width) * static_cast<std::size_t>(film.crop_height), 0);
    const Projection project(view);
    const bool parallel = view.camera.kind == CameraKind::kOrthographic;
    const double least = parallel ? 0 : 0.5 * double{view.camera.near_clip};
    const auto asked = [&](BsdfId id) { return bsdfs[static_cast<std::size_t>(id.value)] != 0; };
    for (const Shape& shape : scene.shapes) {
        const auto shown = bsdfs_of(scene, shape.material);
        if (std::none_of(shown.begin(), shown.end(), asked)) continue;
        const auto mark_triangle = [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) {
            const std::array<Point, 3> triangle{project(a), project(b), project(c)};
            mark(clip_and_project(triangle, least).points(), canvas);
        };
        std::visit([&](const auto& g) { for_triangles_of(scene, g, mark_triangle); },
                   shape.geometry);
    }
    return canvas.pixels;
}

}  // namespace

namespace {

std::vector<char> all_pixels(const Film& film) {
    return std::vector<char>(
        static_cast<std::size_t>(film.crop_width) * static_cast<std::size_t>(film.crop_height), 1);
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
    std::vector<char> rows(pixels.size(), 0), result(pixels.size(), 0);
    const auto at = [width](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x);
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int k = std::max(0, x - reach); k <= std::min(width - 1, x + reach); ++k)
                rows[at(x, y)] |= pixels[at(k, y)];
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int k = std::max(0, y - reach); k <= std::min(height - 1, y + reach); ++k)
                result[at(x, y)] |= rows[at(x, k)];
    return result;
}

}  // namespace burnish
