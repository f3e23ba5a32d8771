// Mesh attributes as textures: a bitmap with four texels for each triangle, between whose centres a
// bilinear look-up is linear in the triangle's barycentric coordinates.
#pragma once

#include <vector>

#include "mitsuba/mesh.h"
#include "mitsuba/node.h"
#include "scene/texture.h"

namespace burnish::mitsuba {

struct Loader;
struct Properties;

/// Where each corner of each triangle reads the bitmaps of attribute_bitmap: [3 * triangles].
std::vector<Vec2f> attribute_uvs(std::size_t triangles);

/// Three channels where the attribute has three or more of them, else one. At least one triangle.
Bitmap attribute_bitmap(const Mesh& mesh, const MeshAttribute& attribute, float scale);

/// The `mesh_attribute` of the shape that is being read. Throws InputError: it has none of that
/// name.
Bitmap read_mesh_attribute(Loader& loader, Properties& properties);

/// Whether an element, or one that it refers to, reads a mesh attribute.
bool reads_attribute(Loader& loader, const Node& node);
/// Forgets what was built of such an element, which is another thing for each shape.
void forget_attributes(Loader& loader, const Node& node);

}  // namespace burnish::mitsuba
