// Constants of materials that are to be recovered: a texture takes their place.
#pragma once

#include <cstddef>
#include <string>

#include "scene/scene.h"

namespace burnish {

/// A parameter as people ask for it: "mat.metallic", or with a size: "mat.metallic:512" or
/// "mat.metallic:512x256".
struct SizedName {
    std::string name;
    int width = 0, height = 0;  ///< 0: none was given
};
SizedName split_size(const std::string& text);
/// The same in a scene: what means bitmaps or constants of it as a whole has no size.
SizedName split_size(const Scene& scene, const std::string& text);

/// Whether a text means bitmaps or constants of a scene, one or several, with or without a size.
bool means_input(const Scene& scene, const std::string& text);

/// A bitmap's place in Scene::parameters, or a constant's in Scene::constants.
struct NamedInput {
    std::size_t index = 0;
    bool is_constant = false;
};
/// The bitmap or the constant that a name without a size means, by the rule of find_parameter over
/// both; a short form means constants that the scene does not give where it fits nothing else.
/// Throws InputError: the name is unknown or ambiguous, or names an input that cannot be recovered
/// better than any that can.
NamedInput find_input(const Scene& scene, const std::string& name);

/// The parameter that a name means: its index in Scene::parameters. A constant becomes a texture of
/// that value, a single texel or of the size that the name gives, and with it a parameter. Throws
/// InputError: as find_input, or a bitmap with another size, or a surface that shows a texture of
/// several texels without texture coordinates.
std::size_t require_parameter(Scene& scene, const std::string& text);

/// The value of a constant, one or three channels.
Image value_of(const Scene& scene, const ConstantParameter& constant);

}  // namespace burnish
