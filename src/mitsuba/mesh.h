// Meshes between a file and the scene: object space, before the shape's transform.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/transform.h"
#include "scene/shape.h"

namespace burnish::mitsuba {

/// What a file gives at the vertices or faces of a mesh.
struct MeshAttribute {
    std::string name;  ///< Mitsuba's: "vertex_color", "face_color"
    bool of_faces = false;
    int channels = 0;           ///< 1 to 4
    std::vector<float> values;  ///< [vertices or triangles, channels]
};

/// What a file holds besides materials and place.
struct MeshFile {
    Mesh mesh = {};
    std::vector<MeshAttribute> attributes = {};
    /// Corners of faces that lack what other corners of the mesh have.
    std::size_t corners_without_uv = 0, corners_without_normal = 0;
    std::size_t concave_faces = 0;  ///< of more than three corners: a fan leaves their outline
    std::size_t materials = 0;      ///< that an OBJ names, or that the faces of a PLY number
};

/// What a reader of meshes calls before it makes one, with the bytes that its vertices and
/// triangles take at least; it may throw.
using BeforeMesh = std::function<void(double bytes)>;

/// The least that so many vertices and triangles take.
inline double min_bytes(std::size_t vertices, std::size_t triangles) {
    return static_cast<double>(vertices) * sizeof(Vec3f) +
           static_cast<double>(triangles) * sizeof(Triangle);
}

struct MeshOptions {
    Transform to_world;
    bool face_normals = false;  ///< drop vertex normals: the geometric normal shades
    bool flip_normals = false;
    /// By which normals are moved, where it is not the inverse of to_world.
    std::optional<Transform> to_local = {};
};

/// Unit normals of faces, weighted by the angle at the vertex.
std::vector<Vec3f> smooth_normals(const Mesh& mesh);

/// A number for each place: vertices are apart where texture coordinates or normals differ.
std::vector<std::uint32_t> places_of(const Mesh& mesh);
/// The same of vertices at one place together, whatever parts them, except of those whose own faces
/// look to the other side, as of a sheet with two sides.
std::vector<Vec3f> smooth_normals_of_places(const Mesh& mesh);

/// Gives vertices whose normal is 0 0 0 the one that smooth_normals has there. Returns how many of
/// these vertices faces use. mesh: no normals, or one for each vertex.
std::size_t fill_zero_normals(Mesh& mesh);
/// What is said of so many, at least one: "2 vertices have the normal 0 0 0: ...".
std::string zero_normals_text(std::size_t count);
/// What is said of the corners of a file that lack what others have, a sentence each.
std::vector<std::string> corner_texts(const MeshFile& file, bool face_normals);

/// To world space. Missing normals are computed (smooth, weighted by angle) unless face_normals. As
/// in Mitsuba, the triangles keep their winding under a mirror, except where the file gives the
/// normals: those decide which side is the front, so the winding follows them. Throws
/// std::domain_error where the transform has no inverse.
Mesh finish_mesh(Mesh mesh, const MeshOptions& options);

/// [-1, 1]^2 at z = 0, normal +z, uv = ((x + 1) / 2, (y + 1) / 2). Both come with the normals of
/// their faces.
Mesh unit_rectangle();
/// [-1, 1]^3 with face normals; every face spans [0, 1]^2 in uv.
Mesh unit_cube();

/// Whether a polygon turns one way at all corners, seen along its normal; but for rounding.
bool is_convex(const std::vector<Vec3f>& positions, const std::vector<std::uint32_t>& polygon);

/// Adds the polygon (counter-clockwise) as a fan of triangles around its first vertex.
void add_fan(std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& polygon);

}  // namespace burnish::mitsuba
