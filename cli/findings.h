// What looks wrong in a scene: each check gives sentences, none where all is well.
//
// To add a check: a function here and a call in inspect.cpp.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace burnish {

using Findings = std::vector<std::string>;

/// No light at all; emitters that give off nothing or a negative amount.
void check_lights(const Scene& scene, Findings& findings);
/// Vertices that are not finite, triangles without area, normals without length.
void check_meshes(const Scene& scene, Findings& findings);
/// Textured meshes without texture coordinates; coordinates outside of a clamped texture.
void check_texture_coordinates(const Scene& scene, Findings& findings);
/// Texels outside [0, 1].
void check_textures(const Scene& scene, Findings& findings);
/// Materials that no shape has.
void check_materials(const Scene& scene, Findings& findings);

}  // namespace burnish
