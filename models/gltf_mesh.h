// Shapes as the triangles that glTF knows.
#pragma once

#include "scene/scene.h"

namespace burnish {

/// The triangles of any shape, in world space, with texture coordinates: what is round is
/// divided finely, a mesh without coordinates gets those that the renderer takes, a triangle's own.
Mesh triangles_of(const Geometry& geometry);
/// The same of a shape of the scene; an instance shows its prototype's, moved.
Mesh triangles_of(const Scene& scene, const Shape& shape);

}  // namespace burnish
