#include "paths/triangles.h"

#include "core/frame.h"
#include "core/parallel.h"

namespace burnish {

namespace {

TriangleRecord make_record(const Mesh& mesh, std::size_t index) {
    const Triangle& triangle = mesh.triangles[index];
    const auto [i0, i1, i2] = triangle.vertex;
    TriangleRecord r;
    r.p0 = mesh.positions[i0];
    r.edge1 = mesh.positions[i1] - r.p0;
    r.edge2 = mesh.positions[i2] - r.p0;
    r.geometric_normal = normalize(cross(r.edge1, r.edge2));
    for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t i = triangle.vertex[k];
        r.normal[k] = mesh.normals.empty() ? r.geometric_normal : mesh.normals[i];
    }
    r.uv = corner_uvs(mesh, triangle);
    r.dp_du = tangents_of(mesh, index).dp_du;
    for (std::size_t k = 0; k < 3 && !mesh.lookup_uvs.empty(); ++k)
        r.uv[k] = mesh.lookup_uvs[3 * index + k];
    return r;
}

}  // namespace

Tangents tangents_of(const Mesh& mesh, std::size_t triangle) {
    const auto [i0, i1, i2] = mesh.triangles[triangle].vertex;
    const Vec3f p0 = mesh.positions[i0];
    const Vec3f edge1 = mesh.positions[i1] - p0, edge2 = mesh.positions[i2] - p0;
    const std::array<Vec2f, 3> uv = corner_uvs(mesh, mesh.triangles[triangle]);
    const Vec2f d1 = uv[1] - uv[0], d2 = uv[2] - uv[0];
    const float determinant = d1.x * d2.y - d1.y * d2.x;
    if (determinant == 0.0f) {
        const Frame any = frame_from_normal(normalize(cross(edge1, edge2)));
        return {any.s, any.t};
    }
    const float scale = 1.0f / determinant;
    return {(edge1 * d2.y - edge2 * d1.y) * scale, (edge2 * d1.x - edge1 * d2.x) * scale};
}

TriangleTable make_triangle_table(const Scene& scene) {
    const std::size_t placed = scene.shapes.size();
    TriangleTable table(placed + scene.prototypes.size());
    parallel_for(table.size(), [&](std::size_t i) {
        const Shape& shape = i < placed ? scene.shapes[i] : scene.prototypes[i - placed];
        const auto* mesh = mesh_of(shape.geometry);
        if (!mesh) return;
        table[i].reserve(mesh->triangles.size());
        for (std::size_t t = 0; t < mesh->triangles.size(); ++t)
            table[i].push_back(make_record(*mesh, t));
    });
    return table;
}

}  // namespace burnish
