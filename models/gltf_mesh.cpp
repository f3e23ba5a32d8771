#include "models/gltf_mesh.h"

#include <cmath>
#include <numbers>

#include "core/variant.h"

namespace burnish {

namespace {

/// A point of a grid over [0, 1]^2.
struct GridPoint {
    Vec3f position, normal;
};

/// Columns x rows quads over point(u, v), their front where the normals are. Triangles without area
/// (a pole) are left out.
template <class Point>
Mesh grid_mesh(int columns, int rows, const Point& point) {
    Mesh mesh;
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) {
            const Vec2f uv{static_cast<float>(i) / static_cast<float>(columns),
                           static_cast<float>(j) / static_cast<float>(rows)};
            const GridPoint p = point(uv);
            mesh.positions.push_back(p.position);
            mesh.normals.push_back(p.normal);
            mesh.uvs.push_back(uv);
        }
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        const Vec3f n =
            cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
        const float side =
            dot(n, mesh.normals[a]) + dot(n, mesh.normals[b]) + dot(n, mesh.normals[c]);
        if (side < 0) std::swap(b, c);
        if (length_squared(n) > 0) mesh.triangles.push_back({{a, b, c}});
    };
    const auto stride = static_cast<std::uint32_t>(columns) + 1;
    for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(rows); ++j)
        for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(columns); ++i) {
            const std::uint32_t k = j * stride + i;
            add(k, k + 1, k + stride);
            add(k + 1, k + stride + 1, k + stride);
        }
    return mesh;
}

constexpr float kTwoPi = 2 * std::numbers::pi_v<float>;

Mesh sphere_mesh(const Sphere& sphere) {
    return grid_mesh(128, 64, [&](const Vec2f& uv) {
        const bool pole = uv.y == 0 || uv.y == 1;
        const float theta = uv.y * kTwoPi / 2, r = pole ? 0 : std::sin(theta);
        const Vec3f n = transform_vector(
            sphere.to_world,
            {r * std::cos(kTwoPi * uv.x), r * std::sin(kTwoPi * uv.x), std::cos(theta)});
        return GridPoint{sphere.center + n * sphere.radius, sphere.flip_normals ? -n : n};
    });
}

Mesh disk_mesh(const Disk& disk) {
    const Vec3f n = transform_normal(disk.to_local, {0, 0, 1});
    return grid_mesh(1, 128, [&](const Vec2f& uv) {
        const Vec3f local{uv.x * std::cos(kTwoPi * uv.y), uv.x * std::sin(kTwoPi * uv.y), 0};
        return GridPoint{transform_point(disk.to_world, local), disk.flip_normals ? -n : n};
    });
}

Mesh cylinder_mesh(const Cylinder& cylinder) {
    return grid_mesh(128, 1, [&](const Vec2f& uv) {
        const Vec3f local{std::cos(kTwoPi * uv.x), std::sin(kTwoPi * uv.x), 0};
        const Vec3f n = transform_normal(cylinder.to_local, local);
        return GridPoint{transform_point(cylinder.to_world, {local.x, local.y, uv.y}),
                         cylinder.flip_normals ? -n : n};
    });
}

/// Each triangle with vertices of its own, and where textures are read for uv: at its barycentric
/// coordinates, unless the mesh says otherwise.
Mesh with_own_uvs(const Mesh& mesh) {
    Mesh split;
    for (const Triangle& t : mesh.triangles) {
        const auto first = static_cast<std::uint32_t>(split.positions.size());
        for (const std::uint32_t v : t.vertex) {
            split.positions.push_back(mesh.positions[v]);
            if (!mesh.normals.empty()) split.normals.push_back(mesh.normals[v]);
        }
        if (mesh.lookup_uvs.empty()) {
            const auto uv = corner_uvs(mesh, t);
            split.uvs.insert(split.uvs.end(), uv.begin(), uv.end());
        } else
            split.uvs.insert(split.uvs.end(), &mesh.lookup_uvs[first], &mesh.lookup_uvs[first] + 3);
        split.triangles.push_back({{first, first + 1, first + 2}});
    }
    return split;
}

}  // namespace

Mesh triangles_of(const Geometry& geometry) {
    return match(
        geometry,
        [](const Mesh& mesh) {
            return mesh.uvs.empty() || !mesh.lookup_uvs.empty() ? with_own_uvs(mesh) : mesh;
        },
        [](const Sphere& sphere) { return sphere_mesh(sphere); },
        [](const Disk& disk) { return disk_mesh(disk); },
        [](const Cylinder& cylinder) { return cylinder_mesh(cylinder); },
        [](const Instance&) { return Mesh{}; });
}

Mesh triangles_of(const Scene& scene, const Shape& shape) {
    const auto* instance = std::get_if<Instance>(&shape.geometry);
    if (!instance) return triangles_of(shape.geometry);
    Mesh mesh = triangles_of(scene.prototypes[instance->prototype].geometry);
    for (Vec3f& p : mesh.positions) p = transform_point(instance->to_world, p);
    for (Vec3f& n : mesh.normals) n = transform_normal(instance->to_local, n);
    if (determinant3(instance->to_world) < 0)
        for (Triangle& t : mesh.triangles) std::swap(t.vertex[1], t.vertex[2]);
    return mesh;
}

}  // namespace burnish
