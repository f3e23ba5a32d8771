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

/// The `mesh_attribute` of the shape that is being read. Calls LoadOptions::before_reading. Throws
/// InputError: it has none of that name.
Bitmap read_mesh_attribute(Loader& loader, Properties& properties);

/// Gives a shape the coordinates by which its textures, of its material and its emitter, find mesh
/// attributes. Throws Unsupported where only some of them are attributes.
void use_attributes(Loader& loader, const Properties& properties, Shape& shape,
                    const std::vector<TextureId>& textures);

/// Whether an element, or one that it refers to, reads a mesh attribute.
bool reads_attribute(Loader& loader, const Node& node);
/// Forgets what was built of such an element, which is another thing for each shape.
void forget_attributes(Loader& loader, const Node& node);

}  // namespace burnish::mitsuba
