// PLY meshes: ASCII, binary little- and big-endian. Vertices x y z [nx ny nz] [u v | s t |
// texture_u texture_v], faces vertex_indices or vertex_index; attributes of both; every other
// element and property is skipped.
#pragma once

#include <filesystem>

#include "mitsuba/mesh.h"

namespace burnish::mitsuba {

struct PlyOptions {
    /// Where vertices have no texture coordinates, those of the faces' corners are read
    /// (`texcoord`, as photogrammetry writes them): a vertex for each pair of a place and a
    /// coordinate. Mitsuba does not know them.
    bool corner_uvs = false;
    BeforeMesh before_mesh = {};
};

/// The mesh in object space with its attributes; polygons become fans. Throws InputError with the
/// line (ASCII and header) or byte offset: malformed, truncated, counts that the file cannot hold,
/// indices out of range, non-finite positions.
MeshFile read_ply_file(const std::filesystem::path& file, const PlyOptions& options = {});

}  // namespace burnish::mitsuba
