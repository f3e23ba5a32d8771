// BSDFs: diffuse, principled, twosided.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "mitsuba/loader.h"

namespace burnish::mitsuba {

namespace {

constexpr const char* kUnsupported =
    "blendbsdf bumpmap circular conductor dielectric hair mask measured measured_polarized "
    "normalmap null plastic "
    "polarizer pplastic principledthin retarder roughconductor roughdielectric roughplastic "
    "thindielectric";

/// A bsdf element being read: its properties, and the name under which its textures are parameters.
struct BsdfReader {
    Loader& loader;
    Properties properties;
    std::string id;
    std::vector<ConstantParameter> constants = {};
};

void add_parameter(BsdfReader& reader, const Property& property, TextureId texture) {
    Scene& scene = reader.loader.result.scene;
    const Bitmap* bitmap = bitmap_of(scene[texture]);
    if (!bitmap) return;
    if (bitmap->is_attribute) {  // no unknown, but known by name
        scene.attribute_inputs.push_back(fmt::format("{}.{}.data", reader.id, property.name));
        return;
    }
    reader.loader.parameters.push_back(
        {property.site->order,
         Parameter{fmt::format("{}.{}.data", reader.id, property.name), texture},
         ParameterSource{reader.properties.node->order, property.name, property.node->order}});
}

/// property: null where the file does not give it.
void add_constant(BsdfReader& reader, const std::string& name, int input,
                  const Property* property) {
    reader.constants.push_back(
        {fmt::format("{}.{}.value", reader.id, name), {}, input, property != nullptr});
}

void warn_outside(BsdfReader& reader, const Property& property, float value) {
    if (!(value >= 0 && value <= 1))
        log_warning(reader.loader, property.site->place,
                    fmt::format("the parameter \"{}\" is {}, expected a value in [0, 1]",
                                property.name, value));
}

ColorInput take_color_input(BsdfReader& reader, const std::string& name) {
    ColorInput input;
    const Property* property = take(reader.properties, name);
    if (property && property->node->tag == "texture") {
        input.texture = load_texture(reader.loader, *property->node);
        add_parameter(reader, *property, input.texture);
        return input;
    }
    add_constant(reader, name, 0, property);
    if (!property) return input;
    input.constant = read_color(*property);
    for (int c = 0; c < 3; ++c)
        if (!(input.constant[c] >= 0 && input.constant[c] <= 1))
            fail(property->site->place,
                 fmt::format("the reflectance \"{}\" has the value {}, expected values in [0, 1]",
                             name, input.constant[c]));
    return input;
}

/// Luminance of a colour; a gray one exactly.
float to_scalar(const Rgbf& c) { return c.x == c.y && c.y == c.z ? c.x : luminance(c); }

struct ScalarReading {
    ScalarInput input;
    bool present = false;  ///< a texture, a colour, or a number other than 0: the lobe exists
};

/// scalar: its number among those of the BSDF.
ScalarReading take_scalar_input(BsdfReader& reader, const std::string& name, float fallback,
                                std::size_t scalar) {
    ScalarReading reading{{fallback, {}}, fallback != 0};
    const Property* property = take(reader.properties, name);
    const bool is_texture = property && property->node->tag == "texture";
    if (!is_texture) add_constant(reader, name, 1 + static_cast<int>(scalar), property);
    if (!property) return reading;
    const std::string& tag = property->node->tag;
    if (tag == "texture") {
        reading.input.texture = load_texture(reader.loader, *property->node);
        add_parameter(reader, *property, reading.input.texture);
        return {reading.input, true};
    }
    reading.input.constant = to_scalar(read_color(*property));
    warn_outside(reader, *property, reading.input.constant);
    return {reading.input, (tag != "float" && tag != "integer") || reading.input.constant != 0};
}

float take_rate(Properties& properties, const char* name) {
    const float rate = take_float(properties, name, 1.0f);
    if (!(rate >= 0))
        fail(properties.node->place,
             fmt::format("the parameter \"{}\" is {}, expected at least 0", name, rate));
    return rate;
}

/// From `eta` or `specular`, of which at most one may be given.
float take_eta(Properties& properties, bool transmits) {
    const Property* given_eta = take(properties, "eta");
    const Property* given_specular = take(properties, "specular");
    if (given_eta && given_specular)
        fail(given_specular->site->place,
             "found both \"eta\" and \"specular\", expected at most one of them");
    if (given_eta) {
        const double eta = take_number(properties, "eta", 1.5);
        if (!(eta >= 1))
            fail(given_eta->site->place, fmt::format("\"eta\" is {}, expected at least 1", eta));
        return eta == 1 && transmits ? 1.001f : static_cast<float>(eta);
    }
    const double specular = take_number(properties, "specular", 0.5);
    if (!(specular >= 0 && specular <= 1))
        fail(given_specular->site->place,
             fmt::format("\"specular\" is {}, expected a value in [0, 1]", specular));
    const double eta = 2 / (1 - std::sqrt(0.08 * specular)) - 1;
    return eta == 1 && transmits ? 1.001f : static_cast<float>(eta);
}

struct ScalarName {
    const char* name;
    float fallback;
};

constexpr std::array<ScalarName, kPrincipledScalars> kScalarNames{{
    {"roughness", 0.5f},
    {"anisotropic", 0},
    {"metallic", 0},
    {"spec_trans", 0},
    {"spec_tint", 0},
    {"sheen", 0},
    {"sheen_tint", 0},
    {"flatness", 0},
    {"clearcoat", 0},
    {"clearcoat_gloss", 0},
}};

Principled read_principled(BsdfReader& reader) {
    Principled bsdf;
    bsdf.base_color = take_color_input(reader, "base_color");
    for (std::size_t i = 0; i < kScalarNames.size(); ++i) {
        const ScalarReading reading =
            take_scalar_input(reader, kScalarNames[i].name, kScalarNames[i].fallback, i);
        bsdf.scalars[i] = reading.input;
        if (bool Principled::*const lobe = kScalarLobes[i]) bsdf.*lobe = reading.present;
    }
    if (!bsdf.has_spec_trans)  // light would pass through: another kind of surface
        std::erase_if(reader.constants, [](const ConstantParameter& c) {
            return c.input == 1 + static_cast<int>(PrincipledScalar::kSpecTrans);
        });
    bsdf.eta = take_eta(reader.properties, bsdf.has_spec_trans);
    bsdf.specular_rate = take_rate(reader.properties, "main_specular_sampling_rate");
    bsdf.clearcoat_rate = take_rate(reader.properties, "clearcoat_sampling_rate");
    bsdf.diffuse_rate = take_rate(reader.properties, "diffuse_reflectance_sampling_rate");
    return bsdf;
}

Bsdf read_bsdf(BsdfReader& reader) {
    if (reader.properties.type == "diffuse")
        return Diffuse{take_color_input(reader, "reflectance")};
    if (reader.properties.type == "principled") return read_principled(reader);
    fail_plugin(*reader.properties.node, kUnsupported,
                "\"diffuse\", \"principled\" or \"twosided\"");
}

BsdfId load_bsdf(Loader& loader, const Node& node, const std::string& id) {
    if (const auto known = loader.bsdfs.find(&node); known != loader.bsdfs.end())
        return known->second;
    BsdfReader reader{loader, open_properties(loader.document, node), id};
    const Bsdf bsdf = read_bsdf(reader);
    warn_unknown(reader.properties, loader.result.warnings);
    auto& bsdfs = loader.result.scene.bsdfs;
    const BsdfId bsdf_id{static_cast<std::int32_t>(bsdfs.size())};
    bsdfs.push_back(bsdf);
    for (ConstantParameter& c : reader.constants) {
        c.bsdf = bsdf_id;
        loader.result.scene.constants.push_back(std::move(c));
    }
    loader.bsdfs.emplace(&node, bsdf_id);
    return bsdf_id;
}

/// One side of a twosided material.
BsdfId load_side(Loader& loader, const Property& side, const std::string& id) {
    if (attribute(*side.node, "type") == "twosided")
        fail(side.site->place, "found \"twosided\" inside \"twosided\", expected a one-sided bsdf");
    const BsdfId bsdf = load_bsdf(loader, *side.node, id);
    if (transmits(loader.result.scene[bsdf]))
        fail(side.site->place,
             "found a bsdf that transmits (spec_trans) inside \"twosided\", expected a reflecting "
             "one");
    return bsdf;
}

Material read_twosided(Loader& loader, const Node& node, const std::string& id) {
    Properties properties = open_properties(loader.document, node);
    const std::vector<const Property*> sides = take_tag(properties, "bsdf");
    if (sides.empty() || sides.size() > 2)
        fail(node.place,
             fmt::format("bsdf \"twosided\" has {} nested bsdfs, expected 1 or 2", sides.size()));
    warn_unknown(properties, loader.result.warnings);
    const BsdfId front = load_side(loader, *sides[0], id + ".brdf_0");
    return {id, front, sides.size() == 1 ? front : load_side(loader, *sides[1], id + ".brdf_1")};
}

}  // namespace

MaterialId load_material(Loader& loader, const Node& node, const std::string& fallback_id) {
    if (const auto known = loader.materials.find(&node); known != loader.materials.end())
        return known->second;
    const std::string& given = attribute(node, "id");
    const std::string id = given.empty() ? fallback_id : given;
    const Material material = attribute(node, "type") == "twosided"
                                  ? read_twosided(loader, node, id)
                                  : Material{id, load_bsdf(loader, node, id), {}};
    auto& materials = loader.result.scene.materials;
    const MaterialId material_id{static_cast<std::int32_t>(materials.size())};
    materials.push_back(material);
    loader.materials.emplace(&node, material_id);
    return material_id;
}

}  // namespace burnish::mitsuba
