// The inputs of a bsdf element, which become parameters of the scene.
#pragma once

#include "mitsuba/loader.h"

namespace burnish::mitsuba {

/// A bsdf element being read: its properties, and the name under which its textures are parameters.
struct BsdfReader {
    Loader& loader;
    Properties properties;
    std::string id;
    std::vector<ConstantParameter> constants = {};
};

// place: in the row of the BSDF (scene/material.h). Throw InputError.

/// A reflectance: its channels lie in [0, 1]. input: where the file does not give it.
ColorInput take_color_input(BsdfReader& reader, const std::string& name, int place = 0,
                            ColorInput input = {});

struct ScalarReading {
    ScalarInput input;
    bool present = false;  ///< a texture, a colour, or a number other than 0: the lobe exists
};
/// Warns of numbers that `use` does not take.
ScalarReading take_scalar_input(BsdfReader& reader, const std::string& name, int place,
                                float fallback, TextureUse use = TextureUse::kMaterial);

/// Makes a parameter `name` of a texture that the bsdf element of `properties` reads; of a mesh
/// attribute, which is no unknown, a name that is known. false: the texture has no texels.
bool add_texture_parameter(Loader& loader, const Properties& properties, const Property& property,
                           const std::string& name, TextureId texture);

/// The BSDF of a bsdf element, built once; id: under which its inputs are parameters.
BsdfId load_bsdf(Loader& loader, const Node& node, const std::string& id);

// Readers of some kinds, by type.

Conductor read_conductor(BsdfReader& reader);
RoughConductor read_rough_conductor(BsdfReader& reader);
Plastic read_plastic(BsdfReader& reader);
/// Without its tables, which make_rough_plastics makes when all are read.
RoughPlastic read_rough_plastic(BsdfReader& reader);
Dielectric read_dielectric(BsdfReader& reader);
Dielectric read_thin_dielectric(BsdfReader& reader);
RoughDielectric read_rough_dielectric(BsdfReader& reader);
/// `null`
Dielectric read_null();

}  // namespace burnish::mitsuba
