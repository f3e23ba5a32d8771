#include "scene/shape.h"

#include <cmath>

#include "core/constants.h"
#include "core/variant.h"

namespace burnish {

const Mesh* mesh_of(const Geometry& geometry) {
    return match(
        geometry, [](const Mesh& mesh) { return &mesh; },
        [](const Sphere&) -> const Mesh* { return nullptr; },
        [](const Disk&) -> const Mesh* { return nullptr; },
        [](const Cylinder&) -> const Mesh* { return nullptr; },
        [](const Instance&) -> const Mesh* { return nullptr; });
}

std::size_t bytes_of(const Mesh& mesh) {
    return (mesh.positions.size() + mesh.normals.size()) * sizeof(Vec3f) +
           (mesh.uvs.size() + mesh.lookup_uvs.size()) * sizeof(Vec2f) +
           mesh.triangles.size() * sizeof(Triangle);
}

double triangle_area(const Mesh& mesh, const Triangle& triangle) {
    const auto at = [&](std::size_t i) { return to_double(mesh.positions[triangle.vertex[i]]); };
    return 0.5 * length(cross(at(1) - at(0), at(2) - at(0)));
}

double area_of(const Geometry& geometry) {
    return match(
        geometry,
        [](const Mesh& mesh) {
            double sum = 0;
            for (const Triangle& t : mesh.triangles) sum += triangle_area(mesh, t);
            return sum;
        },
        [](const Sphere& sphere) { return double{4 * kPi * sphere.radius * sphere.radius}; },
        [](const Disk& disk) {
            const Vec3f x = transform_vector(disk.to_world, {1, 0, 0}),
                        y = transform_vector(disk.to_world, {0, 1, 0});
            return double{kPi * length(cross(x, y))};
        },
        [](const Cylinder& cylinder) {
            const float radius = length(transform_vector(cylinder.to_world, {1, 0, 0})),
                        height = length(transform_vector(cylinder.to_world, {0, 0, 1}));
            return double{2 * kPi * radius * height};
        },
        [](const Instance&) { return 0.0; });
}

namespace {

/// Of the unit circle of the local xy plane.
void include_circle(const Transform& to_world, const Vec3f& local_center, Box& box) {
    const Vec3f center = transform_point(to_world, local_center),
                x = transform_vector(to_world, {1, 0, 0}),
                y = transform_vector(to_world, {0, 1, 0});
    const Vec3f half{std::hypot(x.x, y.x), std::hypot(x.y, y.y), std::hypot(x.z, y.z)};
    box.include(center - half), box.include(center + half);
}

}  // namespace

Box box_of(const Geometry& geometry) {
    Box box;
    match(
        geometry,
        [&](const Mesh& mesh) {
            for (const Triangle& t : mesh.triangles)
                for (const std::uint32_t i : t.vertex) box.include(mesh.positions[i]);
        },
        [&](const Sphere& sphere) {
            const Vec3f r{sphere.radius, sphere.radius, sphere.radius};
            box.include(sphere.center - r), box.include(sphere.center + r);
        },
        [&](const Disk& disk) {
            include_circle(disk.to_world, {0, 0, 0}, box);
        },
        [&](const Cylinder& cylinder) {
            include_circle(cylinder.to_world, {0, 0, 0}, box);
            include_circle(cylinder.to_world, {0, 0, 1}, box);
        },
        [](const Instance&) {});
    return box;
}

}  // namespace burnish
