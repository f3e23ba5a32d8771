// Constants of materials that are to be recovered: a texture takes their place.
#pragma once

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

/// The parameter that a name means: its index in Scene::parameters. A constant becomes a texture of
/// that value, a single texel or of the size that the name gives, and with it a parameter; textures
/// win over constants. Throws InputError: the name is unknown or ambiguous, a bitmap with another
/// size, or a surface that shows a texture of several texels without texture coordinates.
std::size_t require_parameter(Scene& scene, const std::string& text);

/// The constant that a name means, where no texture has the name and one constant alone does.
const ConstantParameter* constant_of(const Scene& scene, const std::string& name);

/// The value of a constant, one or three channels.
Image value_of(const Scene& scene, const ConstantParameter& constant);

}  // namespace burnish
