// Meshes between a file and the scene: object space, before the shape's transform.
#pragma once

#include "core/transform.h"
#include "scene/shape.h"

namespace burnish::mitsuba {

struct MeshOptions {
    Transform to_world;
    bool face_normals = false;  ///< drop vertex normals: the geometric normal shades
    bool flip_normals = false;
};

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

/// Adds the polygon (counter-clockwise) as a fan of triangles around its first vertex.
void add_fan(std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& polygon);

}  // namespace burnish::mitsuba
