// Wavefront OBJ meshes. Materials, groups and smoothing groups are not read: one file is one mesh.
#pragma once

#include <filesystem>

#include "mitsuba/mesh.h"

namespace burnish::mitsuba {

/// The mesh in object space, texture coordinates as in the file; polygons become fans. Corners with
/// the same position, texture coordinate and normal share a vertex. Where only some corners have a
/// texture coordinate, that of the others is (0, 0); where only some have a normal, that of the
/// others is the mean over the faces around them. Throws InputError with the line, or with the byte
/// offset of what is no text.
MeshFile read_obj_file(const std::filesystem::path& file);

}  // namespace burnish::mitsuba
