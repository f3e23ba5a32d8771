// Materials: a BSDF, or one of those that hold others: twosided, mask, blendbsdf, normalmap,
// bumpmap.
#include <fmt/format.h>

#include "mitsuba/bsdf_reader.h"
#include "mitsuba/colors.h"

namespace burnish::mitsuba {

namespace {

MaterialId add_material(Loader& loader, const Material& material) {
    auto& materials = loader.result.scene.materials;
    materials.push_back(material);
    return {static_cast<std::int32_t>(materials.size()) - 1};
}

Material& material_at(Loader& loader, MaterialId id) {
    return loader.result.scene.materials[static_cast<std::size_t>(id.value)];
}

/// Gives a material that was just added its name.
MaterialId named(Loader& loader, MaterialId material, const std::string& id) {
    material_at(loader, material).id = id;
    return material;
}

MaterialId read_material(Loader& loader, const Node& node, const std::string& id);

/// The nested bsdfs, `min` to `max` of them.
std::vector<const Property*> take_nested(Properties& properties, std::size_t min, std::size_t max) {
    std::vector<const Property*> nested = take_tag(properties, "bsdf");
    if (nested.size() < min || nested.size() > max)
        fail(properties.node->place,
             fmt::format("bsdf \"{}\" has {} nested bsdfs, expected {}", properties.type,
                         nested.size(), min == max ? fmt::format("{}", min) : "1 or 2"));
    return nested;
}

/// Lets a material, and those that it blends, reflect on its back as on its front.
void reflect_on_both_sides(Loader& loader, MaterialId id, const Place& place) {
    Material& material = material_at(loader, id);
    if (material.normals && material.back && !material.normals->mirrored)
        fail(place,
             "found \"twosided\" inside a map inside \"twosided\", expected a one-sided bsdf");
    if (material.normals) material.normals->mirrored = true;
    if (material.blend) {
        reflect_on_both_sides(loader, material.blend->first, place);
        reflect_on_both_sides(loader, material.blend->second, place);
    } else if (transmits(loader.result.scene[material.front])) {
        fail(place, "found a bsdf that transmits inside \"twosided\", expected a reflecting one");
    }
    material.back = material.front;
}

/// One side of a twosided material.
MaterialId read_side(Loader& loader, const Property& side, const std::string& id) {
    const MaterialId material = read_material(loader, *side.node, id);
    reflect_on_both_sides(loader, material, side.site->place);
    return material;
}

MaterialId read_twosided(Loader& loader, const Node& node, const std::string& id) {
    Properties properties = open_properties(loader.document, node);
    const std::vector<const Property*> sides = take_nested(properties, 1, 2);
    warn_unknown(properties, loader.result.warnings);
    const MaterialId front = read_side(loader, *sides[0], id + ".brdf_0");
    if (sides.size() == 1) return named(loader, front, id);
    const MaterialId back = read_side(loader, *sides[1], id + ".brdf_1");
    const Scene& scene = loader.result.scene;
    for (const std::size_t k : {std::size_t{0}, std::size_t{1}})
        if (const Material& m = scene[k == 0 ? front : back]; m.blend || m.normals)
            fail(sides[k]->site->place,
                 fmt::format("found a {} on one of two sides, expected one bsdf for both",
                             m.blend ? "blend" : "normal map"));
    material_at(loader, front).back = scene[back].front;
    loader.result.scene.materials.pop_back();  // that of the back
    return named(loader, front, id);
}

/// The share of a blend's second material.
struct Weight {
    ScalarInput input;
    std::optional<ConstantParameter> constant = {};  ///< where no texture gives it
};

/// name: of the parameter.
Weight take_weight_texture(Loader& loader, const Properties& properties, const Property& property,
                           const std::string& name) {
    const TextureId texture = load_texture(loader, *property.node);
    if (!add_texture_parameter(loader, properties, property, name, texture))
        loader.result.scene.layer_inputs.push_back(name);
    return {{0, texture}};
}

Weight take_weight(Loader& loader, Properties& properties, const char* name, const std::string& id,
                   std::optional<float> fallback) {
    const Property* property = take(properties, name);
    if (!property && !fallback)
        fail(properties.node->place,
             fmt::format("bsdf \"{}\" has no \"{}\", expected one", properties.type, name));
    if (property && is_texture(*property))
        return take_weight_texture(loader, properties, *property,
                                   fmt::format("{}.{}.data", id, name));
    Weight weight{{fallback.value_or(0), {}}, ConstantParameter{}};
    weight.constant->name = fmt::format("{}.{}.value", id, name);
    weight.constant->is_given = property != nullptr;
    if (!property) return weight;
    weight.input.constant = mean(read_color(*property));
    if (!(weight.input.constant >= 0 && weight.input.constant <= 1))
        fail(property->site->place,
             fmt::format("\"{}\" is {}, expected a value in [0, 1]", name, weight.input.constant));
    return weight;
}

/// A blend that an element of the file is.
MaterialId add_blend(Loader& loader, const Node& node, const std::string& id, Weight weight,
                     MaterialId first, MaterialId second) {
    Scene& scene = loader.result.scene;
    const MaterialId blend = add_material(loader, {id,
                                                   scene[second].front,
                                                   scene[second].back,
                                                   {},
                                                   MaterialBlend{weight.input, first, second}});
    loader.result.source.blends.emplace(blend.value, node.order);
    if (weight.constant) {
        weight.constant->blend = blend, weight.constant->element = node.order;
        scene.constants.push_back(std::move(*weight.constant));
    }
    return blend;
}

MaterialId read_mask(Loader& loader, const Node& node, const std::string& id) {
    Properties properties = open_properties(loader.document, node);
    const Property& nested = *take_nested(properties, 1, 1)[0];
    Weight opacity = take_weight(loader, properties, "opacity", id, 0.5f);
    warn_unknown(properties, loader.result.warnings);
    auto& bsdfs = loader.result.scene.bsdfs;
    bsdfs.push_back(read_null());
    const MaterialId nothing =
        add_material(loader, {id + ".null", {static_cast<std::int32_t>(bsdfs.size()) - 1}, {}});
    const MaterialId shown = read_material(loader, *nested.node, id + ".nested_bsdf");
    return add_blend(loader, node, id, std::move(opacity), nothing, shown);
}

MaterialId read_blend(Loader& loader, const Node& node, const std::string& id) {
    Properties properties = open_properties(loader.document, node);
    const std::vector<const Property*> nested = take_nested(properties, 2, 2);
    Weight weight = take_weight(loader, properties, "weight", id, {});
    warn_unknown(properties, loader.result.warnings);
    const MaterialId first = read_material(loader, *nested[0]->node, id + ".bsdf_0");
    const MaterialId second = read_material(loader, *nested[1]->node, id + ".bsdf_1");
    return add_blend(loader, node, id, std::move(weight), first, second);
}

/// Lays the map on all that a material shows.
void turn(Loader& loader, MaterialId id, const NormalMap& map, const Place& place) {
    Material& material = material_at(loader, id);
    if (material.normals)
        fail(place, "found a normal or bump map inside another one, expected one of them");
    if (material.blend) {
        turn(loader, material.blend->first, map, place);
        turn(loader, material.blend->second, map, place);
    } else {
        material.normals = map;
    }
}

/// The texture of a `normalmap`.
const Property& take_normals(Properties& properties) {
    const Property* texture = take(properties, "normalmap");
    if (!texture || texture->node->tag != "texture")
        fail(properties.node->place,
             "bsdf \"normalmap\" has no texture \"normalmap\", expected one");
    return *texture;
}

/// The texture of a `bumpmap`, under any name.
const Property& take_heights(Properties& properties) {
    const auto textures = take_tag(properties, "texture");
    if (textures.size() != 1)
        fail(properties.node->place,
             fmt::format("bsdf \"bumpmap\" has {} textures, expected 1", textures.size()));
    return *textures[0];
}

void check_map(Loader& loader, const NormalMap& map, const Place& place) {
    const Bitmap* bitmap = bitmap_of(loader.result.scene[map.texture]);
    if (map.height_scale && (!bitmap || bitmap->is_attribute))
        fail(place, "bsdf \"bumpmap\" has a texture without texels, expected a \"bitmap\"");
    if (!map.height_scale && bitmap && bitmap->channels == 1)
        fail(place,
             "the normal map has one channel, expected three: heights belong in a \"bumpmap\"");
    if (bitmap && !bitmap->raw)
        log_warning(loader, place,
                    fmt::format("the {} map is decoded as colours: expected \"raw\" to be true",
                                map.height_scale ? "bump" : "normal"));
}

MaterialId read_normal_map(Loader& loader, const Node& node, const std::string& id) {
    Properties properties = open_properties(loader.document, node);
    const bool has_heights = properties.type == "bumpmap";
    const Property& nested = *take_nested(properties, 1, 1)[0];
    const Property& texture = has_heights ? take_heights(properties) : take_normals(properties);
    NormalMap map;
    map.texture =
        load_texture(loader, *texture.node, has_heights ? TextureUse::kAny : TextureUse::kMaterial);
    if (has_heights) map.height_scale = take_float(properties, "scale", 1);
    map.flip_invalid = take_boolean(properties, "flip_invalid_normals", true);
    map.shadowing = take_boolean(properties, "use_shadowing_function", true);
    warn_unknown(properties, loader.result.warnings);
    check_map(loader, map, texture.site->place);
    loader.result.scene.layer_inputs.push_back(
        id + (has_heights ? ".nested_texture.data" : ".normalmap.data"));
    const MaterialId inner = read_material(loader, *nested.node, id + ".nested_bsdf");
    turn(loader, inner, map, nested.site->place);
    return named(loader, inner, id);
}

MaterialId read_material(Loader& loader, const Node& node, const std::string& id) {
    constexpr int kMaxBsdfs = 256;
    if (++loader.bsdfs_inside > kMaxBsdfs)
        fail_unsupported(node.place,
                         fmt::format("a bsdf that holds more than {} others, those that it refers "
                                     "to several times counted each time, is not supported yet: "
                                     "expected fewer",
                                     kMaxBsdfs - 1));
    constexpr std::size_t kMin = 2048, kNames = 8;  // inputs have names that begin with the id
    if (!loader.surfaces_read.insert(&node).second)
        add_again(loader, node, kMin + size_of(node) + kNames * id.size());
    const std::string& type = attribute(node, "type");
    if (type == "twosided") return read_twosided(loader, node, id);
    if (type == "mask") return read_mask(loader, node, id);
    if (type == "blendbsdf") return read_blend(loader, node, id);
    if (type == "normalmap" || type == "bumpmap") return read_normal_map(loader, node, id);
    return add_material(loader, {id, load_bsdf(loader, node, id), {}});
}

}  // namespace

MaterialId load_material(Loader& loader, const Node& node, const std::string& id) {
    if (const auto known = loader.materials.find(&node); known != loader.materials.end())
        return known->second;
    loader.bsdfs_inside = 0;
    const MaterialId material = read_material(loader, node, id_or(node, id));
    loader.materials.emplace(&node, material);
    return material;
}

}  // namespace burnish::mitsuba
