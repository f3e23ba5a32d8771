// Wavefront OBJ meshes. Materials, groups and smoothing groups are not read: one file is one mesh.
#pragma once

#include <filesystem>

#include "scene/shape.h"

namespace burnish::mitsuba {

/// The mesh in object space, texture coordinates as in the file; polygons become fans. Corners with
/// the same position, texture coordinate and normal share a vertex. Where some corner lacks a
/// texture coordinate or normal, the mesh has none of them. Throws InputError with the line.
Mesh read_obj(const std::filesystem::path& file);

}  // namespace burnish::mitsuba
