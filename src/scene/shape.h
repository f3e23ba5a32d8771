// Shapes, in world space.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/box.h"
#include "core/transform.h"
#include "core/vec.h"
#include "scene/ids.h"

namespace burnish {

struct Triangle {
    std::array<std::uint32_t, 3> vertex{};
};

/// Triangles in world space (obj, ply, rectangle, cube). The geometric normal is (p1 - p0) x (p2 -
/// p0): the loader has already swapped vertices where the transform mirrors or the scene flips
/// normals.
struct Mesh {
    std::vector<Vec3f> positions;
    std::vector<Vec3f> normals;  ///< unit, per vertex; empty: the face normal shades
    std::vector<Vec2f> uvs;      ///< per vertex; empty: barycentric coordinates are reported as uv
    std::vector<Triangle> triangles;
    /// [3 * triangles]: where textures are read at the corners of each triangle, in the place of
    /// `uvs`, which still give the tangents; empty: at `uvs`.
    std::vector<Vec2f> lookup_uvs = {};
    /// Whether vertices 1 and 2 of all triangles have changed places since the file: barycentric
    /// coordinates are those of the file.
    bool is_turned = false;
};

/// The texture coordinates of a triangle's corners, which give the tangents.
inline std::array<Vec2f, 3> corner_uvs(const Mesh& mesh, const Triangle& t) {
    if (!mesh.uvs.empty())
        return {mesh.uvs[t.vertex[0]], mesh.uvs[t.vertex[1]], mesh.uvs[t.vertex[2]]};
    if (mesh.is_turned) return {{{0, 0}, {0, 1}, {1, 0}}};
    return {{{0, 0}, {1, 0}, {0, 1}}};
}

/// A sphere. Parameterised as in Mitsuba: u = azimuth / 2 pi around the local z axis, v = polar
/// angle / pi.
struct Sphere {
    Vec3f center;
    float radius = 1;
    Transform to_world;  ///< rotation only: orients the texture
    bool flip_normals = false;
};

/// The unit disk of the local xy plane, normal +z, under an affine map. uv = (radius, azimuth / 2
/// pi).
struct Disk {
    Transform to_world, to_local;
    bool flip_normals = false;
};

/// The lateral surface of a cylinder about the local z axis: radius 1, z in [0, 1], under an affine
/// map that keeps its cross-section round. uv = (azimuth / 2 pi, z).
struct Cylinder {
    Transform to_world, to_local;
    bool flip_normals = false;  ///< by default they point outwards
};

/// A shape of Scene::prototypes, placed in the world. It does not emit.
struct Instance {
    std::uint32_t prototype = 0;  ///< index into Scene::prototypes
    Transform to_world, to_local;
};

/// To add a shape: a struct above and its place in this variant. The compiler then names what
/// lacks: scene/shape.cpp, paths/{analytic,surface,lights,light_bounds}.cpp,
/// render/visible_pixels.cpp, cli/inspect.cpp and models/gltf_mesh.cpp. Only its reader in
/// mitsuba/shapes.cpp is not named.
using Geometry = std::variant<Mesh, Sphere, Disk, Cylinder, Instance>;

/// The mesh, or null for shapes that have no triangles and no texture coordinates per vertex.
const Mesh* mesh_of(const Geometry& geometry);
/// What its vertices and triangles take.
std::size_t bytes_of(const Mesh& mesh);

/// In world units squared.
double triangle_area(const Mesh& mesh, const Triangle& triangle);
/// Not of an instance: 0.
double area_of(const Geometry& geometry);
/// Not of an instance: empty.
Box box_of(const Geometry& geometry);

struct Shape {
    std::string id;
    Geometry geometry;
    MaterialId material;
    EmitterId emitter;  ///< invalid: does not emit
};

}  // namespace burnish
