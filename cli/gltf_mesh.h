// Shapes as the triangles that glTF knows.
#pragma once

#include "scene/shape.h"

namespace burnish {

/// The triangles of any shape, in world space, with texture coordinates: a sphere and a disk are
/// divided finely, a mesh without coordinates gets those that the renderer takes, a triangle's own.
Mesh triangles_of(const Geometry& geometry);

}  // namespace burnish
