#include "scene/shape.h"

#include <numbers>

#include "core/variant.h"

namespace burnish {

const Mesh* mesh_of(const Geometry& geometry) {
    return match(
        geometry, [](const Mesh& mesh) { return &mesh; },
        [](const Sphere&) -> const Mesh* { return nullptr; },
        [](const Disk&) -> const Mesh* { return nullptr; });
}

double triangle_area(const Mesh& mesh, const Triangle& triangle) {
    const auto at = [&](std::size_t i) {
        const Vec3f& p = mesh.positions[triangle.vertex[i]];
        return Vec3<double>{p.x, p.y, p.z};
    };
    return 0.5 * length(cross(at(1) - at(0), at(2) - at(0)));
}

double area_of(const Geometry& geometry) {
    constexpr float kPi = std::numbers::pi_v<float>;
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
        });
}

}  // namespace burnish
