#include "mitsuba/mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

namespace burnish::mitsuba {

namespace {

double angle_between(const Vec3<double>& a, const Vec3<double>& b) {
    return std::atan2(length(cross(a, b)), dot(a, b));
}

void swap_winding(Mesh& mesh) {
    for (Triangle& t : mesh.triangles) std::swap(t.vertex[1], t.vertex[2]);
    mesh.is_turned = !mesh.is_turned;
}

/// Of the unit normals of the faces at each vertex, weighted by the angle there [Thuermer and
/// Wuethrich 1998, "Computing Vertex Normals from Polygonal Facets"].
std::vector<Vec3<double>> normal_sums(const Mesh& mesh) {
    std::vector<Vec3<double>> sums(mesh.positions.size());
    for (const Triangle& t : mesh.triangles) {
        const auto corner = [&](std::size_t i) {
            return to_double(mesh.positions[t.vertex[i % 3]]);
        };
        const Vec3<double> normal = cross(corner(1) - corner(0), corner(2) - corner(0));
        const double area = length(normal);
        if (!(area > 0)) continue;
        for (std::size_t i = 0; i < 3; ++i)
            sums[t.vertex[i]] +=
                normal *
                (angle_between(corner(i + 1) - corner(i), corner(i + 2) - corner(i)) / area);
    }
    return sums;
}

std::vector<Vec3f> units_along(const std::vector<Vec3<double>>& sums) {
    std::vector<Vec3f> normals(sums.size());
    std::transform(sums.begin(), sums.end(), normals.begin(), [](const Vec3<double>& sum) {
        const double l = length(sum);
        if (!(l > 0)) return Vec3f{1, 0, 0};  // no face uses the vertex, or its faces cancel
        return Vec3f{static_cast<float>(sum.x / l), static_cast<float>(sum.y / l),
                     static_cast<float>(sum.z / l)};
    });
    return normals;
}

}  // namespace

std::vector<Vec3f> smooth_normals(const Mesh& mesh) { return units_along(normal_sums(mesh)); }

std::vector<std::uint32_t> places_of(const Mesh& mesh) {
    std::map<std::tuple<float, float, float>, std::uint32_t> known;
    std::vector<std::uint32_t> places;
    for (const Vec3f& p : mesh.positions)
        places.push_back(
            known.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(known.size()))
                .first->second);
    return places;
}

std::vector<Vec3f> smooth_normals_of_places(const Mesh& mesh) {
    constexpr double kCancelled = 1e-3;  // far above rounding
    std::vector<Vec3<double>> sums = normal_sums(mesh), at_place(sums.size());
    const std::vector<std::uint32_t> places = places_of(mesh);
    for (std::size_t v = 0; v < sums.size(); ++v) at_place[places[v]] += sums[v];
    for (std::size_t v = 0; v < sums.size(); ++v) {
        const Vec3<double>& all = at_place[places[v]];
        if (dot(all, sums[v]) > kCancelled * dot(sums[v], sums[v])) sums[v] = all;
    }
    return units_along(sums);
}

std::size_t fill_zero_normals(Mesh& mesh) {
    const Vec3f zero{0, 0, 0};
    if (std::find(mesh.normals.begin(), mesh.normals.end(), zero) == mesh.normals.end()) return 0;
    std::vector<char> has_face(mesh.normals.size());
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t.vertex) has_face[v] = 1;
    const std::vector<Vec3f> around = smooth_normals(mesh);
    std::size_t count = 0;
    for (std::size_t v = 0; v < mesh.normals.size(); ++v)
        if (mesh.normals[v] == zero) mesh.normals[v] = around[v], count += has_face[v] != 0;
    return count;
}

std::string zero_normals_text(std::size_t count) {
    return fmt::format("{} the normal 0 0 0: computed from the faces around",
                       count == 1 ? "1 vertex has" : fmt::format("{} vertices have", count));
}

std::vector<std::string> corner_texts(const MeshFile& file, bool face_normals) {
    std::vector<std::string> texts;
    const auto add = [&](std::size_t missing, const char* what, const char* taken) {
        if (missing > 0)
            texts.push_back(fmt::format("{} corners of the faces lack the {} that others have: {}",
                                        missing, what, taken));
    };
    add(file.corners_without_uv, "texture coordinates", "read as 0 0");
    if (!face_normals)
        add(file.corners_without_normal, "normals", "computed from the faces around them");
    return texts;
}

Mesh finish_mesh(Mesh mesh, const MeshOptions& options) {
    const Transform to_local = options.to_local.value_or(inverse(options.to_world));
    if (options.face_normals) mesh.normals.clear();
    if (!mesh.normals.empty() && determinant3(options.to_world) < 0) swap_winding(mesh);
    for (Vec3f& p : mesh.positions) p = transform_point(options.to_world, p);
    for (Vec3f& n : mesh.normals) {
        n = transform_normal(to_local, n);
        if (!is_finite(n)) n = {1, 0, 0};  // its length underflows
    }
    if (mesh.normals.empty() && !options.face_normals) mesh.normals = smooth_normals(mesh);
    if (options.flip_normals) {
        swap_winding(mesh);
        for (Vec3f& n : mesh.normals) n = -n;
    }
    return mesh;
}

bool is_convex(const std::vector<Vec3f>& positions, const std::vector<std::uint32_t>& polygon) {
    constexpr double kRounding = 1e-3;  // the sine of a turn
    const std::size_t n = polygon.size();
    const auto corner = [&](std::size_t i) { return to_double(positions[polygon[i % n]]); };
    Vec3<double> normal;  // of twice the area [Newell]
    for (std::size_t i = 2; i < n; ++i)
        normal += cross(corner(i - 1) - corner(0), corner(i) - corner(0));
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3<double> a = corner(i + 1) - corner(i), b = corner(i + 2) - corner(i + 1);
        if (dot(cross(a, b), normal) < -kRounding * length(a) * length(b) * length(normal))
            return false;
    }
    return true;
}

void add_fan(std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& polygon) {
    for (std::size_t i = 2; i < polygon.size(); ++i)
        triangles.push_back({{polygon[0], polygon[i - 1], polygon[i]}});
}

namespace {

/// The square center + (2u - 1) a + (2v - 1) b; (u, v) may be left-handed seen from the front.
void add_square(Mesh& mesh, const Vec3f& normal, const Vec3f& center, const Vec3f& a,
                const Vec3f& b) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec2f uv : {Vec2f{0, 0}, Vec2f{1, 0}, Vec2f{1, 1}, Vec2f{0, 1}}) {
        mesh.positions.push_back(center + a * (2 * uv.x - 1) + b * (2 * uv.y - 1));
        mesh.normals.push_back(normal);
        mesh.uvs.push_back(uv);
    }
    std::vector<std::uint32_t> corners{first, first + 1, first + 2, first + 3};
    if (dot(cross(a, b), normal) < 0) std::reverse(corners.begin(), corners.end());
    add_fan(mesh.triangles, corners);
}

}  // namespace

Mesh unit_rectangle() {
    Mesh mesh;
    add_square(mesh, {0, 0, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    return mesh;
}

Mesh unit_cube() {
    Mesh mesh;
    const Vec3f x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    add_square(mesh, -y, -y, z, x);
    add_square(mesh, y, y, -x, -z);
    add_square(mesh, x, x, y, -z);
    add_square(mesh, z, z, y, x);
    add_square(mesh, -x, -x, y, z);
    add_square(mesh, -z, -z, -y, x);
    return mesh;
}

}  // namespace burnish::mitsuba
