// A scene's triangles as the renderer meets them: at random. Everything that one hit needs lies in
// two neighbouring cache lines, instead of in up to ten spread over index, position, normal and
// texture coordinate arrays.
#pragma once

#include <array>
#include <vector>

#include "burnish/scene/scene.h"

namespace burnish {

struct alignas(64) TriangleRecord {
    Vec3f p0, edge1, edge2;       ///< vertex 0, and the way to vertices 1 and 2
    Vec3f geometric_normal;       ///< unit
    Vec3f dp_du;                  ///< any tangent where the texture coordinates are degenerate
    std::array<Vec3f, 3> normal;  ///< per vertex, unit; all geometric where the mesh has none
    std::array<Vec2f, 3> uv;      ///< per vertex; (0, 0), (1, 0), (0, 1) where the mesh has none
};
static_assert(sizeof(TriangleRecord) == 128);

/// Records of each shape, parallel to Scene::shapes; empty for shapes that are not meshes.
using TriangleTable = std::vector<std::vector<TriangleRecord>>;

TriangleTable make_triangle_table(const Scene& scene);

/// Asks for a record's memory before it is needed.
inline void prefetch(const TriangleRecord& record) {
    __builtin_prefetch(&record);
    __builtin_prefetch(reinterpret_cast<const char*>(&record) + 64);
}

}  // namespace burnish
