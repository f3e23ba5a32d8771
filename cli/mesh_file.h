// Meshes as people have them: OBJ, PLY and GLB files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/shape.h"

namespace burnish {

/// A mesh of a file.
struct FoundMesh {
    Mesh mesh;  ///< texture coordinates as Mitsuba has them in PLY: v downwards; with normals
    std::vector<std::string> notes;  ///< what was not read, or not rightly, one sentence each
    bool is_double_sided = false;    ///< a material says so
};

/// Of coordinates: a camera that sees all of such a mesh stands within kMaxDistance.
inline constexpr double kMaxMeshReach = 1e11;
/// The first vertex from `begin` on that lies beyond kMaxMeshReach or is not finite; else their
/// number.
std::size_t find_far_vertex(const Mesh& mesh, std::size_t begin = 0);

/// Of a file with several.
std::string note_of_materials(std::size_t count);

/// By the extension: .obj, .ply (texture coordinates of vertices or of the corners of faces; v
/// upwards in both, as in Blender and MeshLab) or .glb (the triangles of its scene, moved where its
/// nodes place them; flat where a primitive has no normals). An OBJ or PLY file without normals
/// gets smooth ones, of vertices at one place together. Throws InputError: malformed, a vertex
/// beyond kMaxMeshReach, or a kind of file that is not known.
FoundMesh read_mesh(const std::filesystem::path& file);

/// Of binary glTF 2.0. Throws InputError: file, place, what was found and what was expected.
FoundMesh read_glb(const std::filesystem::path& file);

}  // namespace burnish
