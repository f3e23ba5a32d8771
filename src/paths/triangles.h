// A scene's triangles as the renderer meets them: at random. Everything that one hit needs lies in
// two neighbouring cache lines, instead of in up to ten spread over index, position, normal and
// texture coordinate arrays.
#pragma once

#include <array>
#include <cstring>
#include <vector>

#include "core/packet.h"
#include "scene/scene.h"

namespace burnish {

/// T: float, or Packet for sixteen triangles.
template <class T>
struct alignas(64) TriangleOf {
    Vec3<T> p0, edge1, edge2;       ///< vertex 0, and the way to vertices 1 and 2
    Vec3<T> geometric_normal;       ///< unit
    Vec3<T> dp_du;                  ///< any tangent where the texture coordinates are degenerate
    std::array<Vec3<T>, 3> normal;  ///< per vertex, unit; all geometric where the mesh has none
    std::array<Vec2<T>, 3> uv;      ///< per vertex, where textures are read; (0, 0), (1, 0), (0, 1)
                                    ///< where the mesh has none
};
using TriangleRecord = TriangleOf<float>;
static_assert(sizeof(TriangleRecord) == 128);

/// Records of each shape, those of Scene::shapes and behind them those of Scene::prototypes, which
/// lie in their own space; empty for shapes that are not meshes.
using TriangleTable = std::vector<std::vector<TriangleRecord>>;

/// Derivatives of the position by the texture coordinate. dp_du gives the shading frame its
/// direction.
struct Tangents {
    Vec3f dp_du, dp_dv;
};

/// Of a mesh's triangle: any two of length 1 where the texture coordinates are degenerate.
Tangents tangents_of(const Mesh& mesh, std::size_t triangle);

TriangleTable make_triangle_table(const Scene& scene);

/// Asks for a record's memory before it is needed.
inline void prefetch(const TriangleRecord& record) {
    __builtin_prefetch(&record);
    __builtin_prefetch(reinterpret_cast<const char*>(&record) + 64);
}

/// The same of what a ray met, where that is a mesh.
inline void prefetch(const TriangleTable& table, std::int32_t shape, std::int32_t primitive) {
    if (shape < 0) return;
    const auto& records = table[static_cast<std::size_t>(shape)];
    if (!records.empty()) prefetch(records[static_cast<std::size_t>(primitive)]);
}

/// Sixteen records, one per lane.
inline TriangleOf<Packet> gather(const std::array<const TriangleRecord*, kLanes>& records) {
    TriangleOf<Packet> result;
    PacketBlock fields[2];
    for (std::size_t half = 0; half < 2; ++half) {
        for (std::size_t i = 0; i < kLanes; ++i)
            fields[half][i] = load(reinterpret_cast<const float*>(records[i]) + half * kLanes);
        transpose(fields[half]);
    }
    static_assert(sizeof(result) <= sizeof(fields));
    std::memcpy(&result, fields, sizeof(result));  // the same fields in the same order
    return result;
}

}  // namespace burnish
