// What looks wrong in a scene: each check gives sentences, none where all is well.
//
// To add a check: a function here and a call in inspect.cpp.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "paths/traced_scene.h"
#include "scene/scene.h"

namespace burnish {

using Findings = std::vector<std::string>;

/// No light at all; emitters that give off nothing or a negative amount.
void check_lights(const Scene& scene, Findings& findings);
/// Vertices that are not finite, triangles without area, normals without length.
void check_meshes(const Scene& scene, Findings& findings);
/// Textured meshes without texture coordinates; coordinates outside of a clamped texture.
void check_texture_coordinates(const Scene& scene, Findings& findings);
/// Texels outside [0, 1], of `diff_trans` outside [0, 2].
void check_textures(const Scene& scene, Findings& findings);
/// Texels of parameters that several places of a mesh read, apart from repetitions.
void check_overlaps(const Scene& scene, Findings& findings);
/// Texels of parameters that several meshes read.
void check_shared_textures(const Scene& scene, Findings& findings);
/// Many more texels of parameters than pixels that show them. pixels: parallel to parameters.
void check_resolution(const Scene& scene, std::span<const double> pixels, Findings& findings);
/// Closed meshes whose normals point inwards, and normals that contradict their triangles.
void check_orientations(const TracedScene& traced, Findings& findings);
/// Shapes with parameters that rays begin visibly off.
void check_places(const Scene& scene, Findings& findings);
/// Lights that one surface keeps from everything else.
void check_enclosed_lights(const TracedScene& traced, Findings& findings);
/// Materials that no shape has.
void check_materials(const Scene& scene, Findings& findings);

/// Whether a material reads the bitmap of a parameter.
bool has_parameter(const Scene& scene, MaterialId material);
/// The materials that blend nothing and that a material may show: a blend with a constant weight of
/// 0 or 1 shows one of its two. The first one of a mask is nothing, which transmits.
std::vector<MaterialId> shown_parts(const Scene& scene, MaterialId material);
/// Whether a material is black from behind wherever it is seen, whatever the light.
bool has_black_back(const Scene& scene, MaterialId material);

/// What messages call an emitter.
std::string label_of_emitter(const Scene& scene, std::size_t emitter);

}  // namespace burnish
