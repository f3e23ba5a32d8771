#include "scenes/scene_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <numbers>

namespace burnish::procedural {

static_assert(std::endian::native == std::endian::little, "ply_bytes writes memory as it lies");

namespace {

template <class Value>
void append(std::string& bytes, const Value& value) {
    char raw[sizeof(Value)];
    std::memcpy(raw, &value, sizeof(Value));
    bytes.append(raw, sizeof(Value));
}

}  // namespace

void add_flat_triangle(Mesh& mesh, const Vec3<double>& a, const Vec3<double>& b,
                       const Vec3<double>& c) {
    const Vec3<double> n = normalize(cross(b - a, c - a));
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3<double>& p : {a, b, c}) {
        mesh.positions.push_back(to_float(p));
        mesh.normals.push_back(to_float(n));
        mesh.uvs.push_back({0, 0});
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
}

void append_mesh(Mesh& mesh, const Mesh& part) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
    mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
    mesh.uvs.insert(mesh.uvs.end(), part.uvs.begin(), part.uvs.end());
    for (const auto& [t] : part.triangles)
        mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

namespace {

/// Lengths along the backdrop's profile.
struct BackdropLengths {
    double floor, arc, wall;
};
BackdropLengths lengths_of(const Backdrop& shape) {
    return {shape.front + shape.back - shape.arc, 0.5 * std::numbers::pi * shape.arc,
            shape.height - shape.arc};
}

}  // namespace

double backdrop_floor_end(const Backdrop& shape) {
    const BackdropLengths l = lengths_of(shape);
    return l.floor / (l.floor + l.arc + l.wall);
}

Mesh make_backdrop(const Backdrop& shape) {
    const BackdropLengths l = lengths_of(shape);
    return tessellate(8, 96, [&](double a, double b) {
        const double v = 1 - b, s = v * (l.floor + l.arc + l.wall);
        const double angle = std::clamp((s - l.floor) / shape.arc, 0.0, 0.5 * std::numbers::pi);
        const double on_floor = std::fmin(s, l.floor),
                     on_wall = std::fmax(s - l.floor - l.arc, 0.0);
        return PatchPoint{
            {(2 * a - 1) * shape.half_width, shape.arc * (1 - std::cos(angle)) + on_wall,
             shape.front - on_floor - shape.arc * std::sin(angle)},
            {a, v}};
    });
}

std::string ply_bytes(const Mesh& mesh) {
    std::string bytes = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property float nx\nproperty float ny\nproperty float nz\n"
        "property float u\nproperty float v\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.positions.size(), mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        append(bytes, mesh.positions[i]);
        append(bytes, mesh.normals[i]);
        append(bytes, mesh.uvs[i]);
    }
    for (const Triangle& triangle : mesh.triangles) {
        append(bytes, std::uint8_t{3});
        append(bytes, triangle);
    }
    return bytes;
}

}  // namespace burnish::procedural
