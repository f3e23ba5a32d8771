#include "models/gltf_material.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "models/gltf_picture.h"
#include "shading/bsdf.h"

namespace burnish {

namespace {

using enum PrincipledScalar;

/// What a material is made with.
struct MaterialWriter {
    const TextureTable& table;
    GltfSurface surface;
};

/// The index of the coordinates that a texture reads.
std::size_t uv_set(MaterialWriter& writer, const UvTransform& to_uv) {
    std::vector<UvTransform>& sets = writer.surface.uv_sets;
    std::size_t i = 0;
    while (i < sets.size() && sets[i].m != to_uv.m) ++i;
    if (i == sets.size()) sets.push_back(to_uv);
    return i;
}

/// A factor with, perhaps, a texture: what glTF multiplies.
struct Slot {
    Rgbf factor{1, 1, 1};
    GltfJson texture;  ///< null without one
};

/// A colour that depends on textures: a picture of it, or its value where there is none to read.
Slot make_slot(MaterialWriter& writer, const std::vector<TextureId>& read, bool srgb,
               const ColorAt& color) {
    const std::optional<Raster> raster = joint_raster(writer.table, read);
    if (!raster) return {color({0, 0}), {}};
    std::vector<GltfTexture>& textures = writer.surface.textures;
    textures.push_back(
        {encode_png(picture_of(*raster, srgb, color)), raster->filter, raster->wrap});
    return {{1, 1, 1},
            {{"index", textures.size() - 1}, {"texCoord", uv_set(writer, raster->to_uv)}}};
}

float unit(float v) { return std::clamp(v, 0.0f, 1.0f); }
GltfJson unit(const Rgbf& c) { return {unit(c.x), unit(c.y), unit(c.z)}; }

void set_texture(GltfJson& object, const char* name, const Slot& slot) {
    if (!slot.texture.is_null()) object[name] = slot.texture;
}

void add_extension(MaterialWriter& writer, const char* name, const GltfJson& extension) {
    writer.surface.json["extensions"][name] = extension;
}

/// A number in all channels.
Slot scalar_slot(MaterialWriter& writer, const ScalarInput& input) {
    return make_slot(writer, {input.texture}, false, [&](const Vec2f& uv) {
        const float v = unit(eval_scalar(writer.table, input, uv));
        return Rgbf{v, v, v};
    });
}

void set_base_color(MaterialWriter& writer, const Slot& slot) {
    GltfJson& pbr = writer.surface.json["pbrMetallicRoughness"];
    pbr["baseColorFactor"] = {unit(slot.factor.x), unit(slot.factor.y), unit(slot.factor.z), 1};
    set_texture(pbr, "baseColorTexture", slot);
}

void set_base_color(MaterialWriter& writer, const ColorInput& input) {
    const Slot slot = make_slot(writer, {input.texture}, true, [&](const Vec2f& uv) {
        return eval_color(writer.table, input, uv);
    });
    set_base_color(writer, slot);
}

/// A roughness, or the alpha whose root it is.
struct RoughnessInput {
    ScalarInput input;
    bool is_alpha = false;
};

/// Roughness in G, metallic in B. A constant is the factor of a channel that is 1.
void set_metallic_roughness(MaterialWriter& writer, const RoughnessInput& roughness,
                            const ScalarInput& metallic) {
    const auto value = [&](const ScalarInput& input, const Vec2f& uv) {
        return unit(eval_scalar(writer.table, input, uv));
    };
    const auto roughness_at = [&](const Vec2f& uv) {
        const float v = value(roughness.input, uv);
        return roughness.is_alpha ? std::sqrt(v) : v;
    };
    const bool rough_varies = raster_of(writer.table, roughness.input.texture).has_value();
    const bool metal_varies = raster_of(writer.table, metallic.texture).has_value();
    const Slot slot =
        make_slot(writer, {roughness.input.texture, metallic.texture}, false, [&](const Vec2f& uv) {
            return Rgbf{1, rough_varies ? roughness_at(uv) : 1,
                        metal_varies ? value(metallic, uv) : 1};
        });
    GltfJson& pbr = writer.surface.json["pbrMetallicRoughness"];
    pbr["roughnessFactor"] = rough_varies ? 1 : roughness_at({0, 0});
    pbr["metallicFactor"] = metal_varies ? 1 : value(metallic, {0, 0});
    set_texture(pbr, "metallicRoughnessTexture", slot);
}

/// Mitsuba's lobe is a quarter of its weight, and of a roughness squared that falls with the gloss.
void set_clearcoat(MaterialWriter& writer, const Principled& p) {
    const Slot weight = scalar_slot(writer, p[kClearcoat]);
    const ScalarInput& gloss = p[kClearcoatGloss];
    const Slot roughness = make_slot(writer, {gloss.texture}, false, [&](const Vec2f& uv) {
        const float v = std::sqrt(clearcoat_alpha(unit(eval_scalar(writer.table, gloss, uv))));
        return Rgbf{v, v, v};
    });
    GltfJson coat{{"clearcoatFactor", 0.25f * weight.factor.x},
                  {"clearcoatRoughnessFactor", roughness.factor.x}};
    set_texture(coat, "clearcoatTexture", weight);
    set_texture(coat, "clearcoatRoughnessTexture", roughness);
    add_extension(writer, "KHR_materials_clearcoat", coat);
}

/// Between white and the hue of the base colour.
Rgbf tinted(const MaterialWriter& writer, const Principled& p, PrincipledScalar by,
            const Vec2f& uv) {
    const Rgbf hue = principled_tint(eval_color(writer.table, p.base_color, uv));
    const float t = unit(eval_scalar(writer.table, p[by], uv));
    return {lerp(1.0f, hue.x, t), lerp(1.0f, hue.y, t), lerp(1.0f, hue.z, t)};
}

/// The textures of a tint; the base colour's only where there is one.
std::vector<TextureId> tint_textures(const Principled& p, PrincipledScalar by, bool has) {
    if (!has) return {};
    return {p[by].texture, p.base_color.texture};
}

void set_sheen(MaterialWriter& writer, const Principled& p) {
    std::vector<TextureId> read = tint_textures(p, kSheenTint, p.has_sheen_tint);
    read.insert(read.begin(), {p[kSheen].texture, p[kMetallic].texture});
    const Slot slot = make_slot(writer, read, true, [&](const Vec2f& uv) {
        const float weight = eval_scalar(writer.table, p[kSheen], uv) *
                             (1 - eval_scalar(writer.table, p[kMetallic], uv));
        return tinted(writer, p, kSheenTint, uv) * weight;
    });
    GltfJson sheen{{"sheenColorFactor", unit(slot.factor)}, {"sheenRoughnessFactor", 0.5f}};
    set_texture(sheen, "sheenColorTexture", slot);
    add_extension(writer, "KHR_materials_sheen", sheen);
}

/// The direction is that of growing u; the strength is in B. Blender's importer gives a direction
/// to what has a texture alone.
void set_anisotropy(MaterialWriter& writer, const Principled& p) {
    const ScalarInput& input = p[kAnisotropic];
    const Slot slot = make_slot(writer, {input.texture}, false, [&](const Vec2f& uv) {
        return Rgbf{1, 0.5f, unit(eval_scalar(writer.table, input, uv))};
    });
    GltfJson anisotropy{{"anisotropyStrength", slot.factor.z}};
    if (!slot.texture.is_null()) {
        anisotropy["anisotropyStrength"] = 1.0f;
        anisotropy["anisotropyTexture"] = slot.texture;
    } else if (slot.factor.z > 0) {
        std::vector<GltfTexture>& textures = writer.surface.textures;
        textures.push_back({encode_png(CodedImage{1, 1, 3, false, {255, 128, 255}})});
        anisotropy["anisotropyTexture"] = {{"index", textures.size() - 1},
                                           {"texCoord", uv_set(writer, {})}};
    }
    add_extension(writer, "KHR_materials_anisotropy", anisotropy);
}

/// A hue has channels above 1, which a factor may have and a picture may not: it is divided by its
/// largest one.
void set_specular_tint(MaterialWriter& writer, const Principled& p) {
    const std::vector<TextureId> read = tint_textures(p, kSpecTint, true);
    const auto tint = [&](const Vec2f& uv) { return tinted(writer, p, kSpecTint, uv); };
    const std::optional<Raster> raster = joint_raster(writer.table, read);
    const float max = raster ? std::max(1.0f, largest_of(*raster, tint)) : 1;
    const Slot slot =
        make_slot(writer, read, true, [&](const Vec2f& uv) { return tint(uv) * (1 / max); });
    const Rgbf factor = slot.factor * max;
    GltfJson specular{{"specularColorFactor", {factor.x, factor.y, factor.z}}};
    set_texture(specular, "specularColorTexture", slot);
    add_extension(writer, "KHR_materials_specular", specular);
}

void set_transmission(MaterialWriter& writer, const ScalarInput& share) {
    const Slot slot = scalar_slot(writer, share);
    GltfJson transmission{{"transmissionFactor", slot.factor.x}};
    set_texture(transmission, "transmissionTexture", slot);
    add_extension(writer, "KHR_materials_transmission", transmission);
}

void set_bsdf(MaterialWriter& writer, const Diffuse& diffuse) {
    set_base_color(writer, diffuse.reflectance);
    set_metallic_roughness(writer, {{1, {}}}, {0, {}});
    add_extension(writer, "KHR_materials_specular", {{"specularFactor", 0}});
}

void set_bsdf(MaterialWriter& writer, const Principled& p) {
    set_base_color(writer, p.base_color);
    set_metallic_roughness(writer, {p[kRoughness]}, p[kMetallic]);
    add_extension(writer, "KHR_materials_ior", {{"ior", p.eta}});
    if (p.has_spec_tint) set_specular_tint(writer, p);
    if (p.has_clearcoat) set_clearcoat(writer, p);
    if (p.has_sheen) set_sheen(writer, p);
    if (p.has_anisotropic) set_anisotropy(writer, p);
    if (p.has_spec_trans) set_transmission(writer, p[kSpecTrans]);
}

RoughnessInput alpha_of(const FacetRoughness& roughness) { return {roughness.alpha[0], true}; }

/// A metal's colour is its reflectance at normal incidence, times that of the surface.
void set_metal(MaterialWriter& writer, const ColorInput& reflectance, const MetalIndex& index,
               const RoughnessInput& roughness) {
    const Rgbf f = fresnel_conductor(1.0f, index.eta, index.k);
    const Slot slot = make_slot(writer, {reflectance.texture}, true, [&](const Vec2f& uv) {
        return eval_color(writer.table, reflectance, uv) * f;
    });
    set_base_color(writer, slot);
    set_metallic_roughness(writer, roughness, {1, {}});
}

void set_bsdf(MaterialWriter& writer, const Conductor& b) {
    set_metal(writer, b.reflectance, b.index, {{0, {}}});
}

void set_bsdf(MaterialWriter& writer, const RoughConductor& b) {
    set_metal(writer, b.reflectance, b.index, alpha_of(b.roughness));
}

void set_plastic(MaterialWriter& writer, const ColorInput& base, float eta,
                 const RoughnessInput& roughness) {
    set_base_color(writer, base);
    set_metallic_roughness(writer, roughness, {0, {}});
    add_extension(writer, "KHR_materials_ior", {{"ior", std::max(1.0f, eta)}});
}
void set_bsdf(MaterialWriter& writer, const Plastic& b) {
    set_plastic(writer, b.colors[0], b.eta, {{0, {}}});
}
void set_bsdf(MaterialWriter& writer, const RoughPlastic& b) {
    set_plastic(writer, b.colors[0], b.eta, {{b.alpha, {}}, true});
}

void set_glass(MaterialWriter& writer, const ColorInput& transmittance, float eta,
               const RoughnessInput& roughness) {
    set_plastic(writer, transmittance, eta, roughness);
    add_extension(writer, "KHR_materials_transmission", {{"transmissionFactor", 1}});
}
void set_bsdf(MaterialWriter& writer, const Dielectric& b) {
    set_glass(writer, b.colors[1], b.eta, {{0, {}}});
}
void set_bsdf(MaterialWriter& writer, const RoughDielectric& b) {
    set_glass(writer, b.colors[1], b.eta, alpha_of(b.roughness));
}

/// A sheet; what it passes on is counted as transmission.
void set_bsdf(MaterialWriter& writer, const PrincipledThin& b) {
    const auto scalar = [&](ThinScalar s) { return b.scalars[static_cast<std::size_t>(s)]; };
    set_base_color(writer, b.base_color);
    set_metallic_roughness(writer, {scalar(ThinScalar::kRoughness)}, {0, {}});
    add_extension(writer, "KHR_materials_ior", {{"ior", std::max(1.0f, b.eta)}});
    set_transmission(writer, scalar(ThinScalar::kSpecTrans));
}

/// Without a thickness, what transmits is a sheet that does not refract. How large it is matters to
/// viewers that do not trace rays.
void set_volume(MaterialWriter& writer) {
    GltfJson& json = writer.surface.json;
    if (json.contains("extensions") && json["extensions"].contains("KHR_materials_transmission"))
        add_extension(writer, "KHR_materials_volume", {{"thicknessFactor", 1}});
}

/// glTF's emission is a colour up to 1 times a strength.
void set_emission(GltfJson& json, const Rgbf& radiance) {
    const float strength = std::max({radiance.x, radiance.y, radiance.z});
    if (!(strength > 0)) return;
    json["emissiveFactor"] = unit(radiance * (1 / strength));
    json["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", strength}};
}

/// Gives what refers to textures, an object with their coordinates, other indices.
void renumber_textures(GltfJson& json, const std::vector<int>& indices) {
    if (json.contains("texCoord"))
        json["index"] = indices[json["index"].get<std::size_t>()];
    else if (json.is_object())
        for (GltfJson& child : json) renumber_textures(child, indices);
}

}  // namespace

GltfSurface make_surface(const Scene& scene, const TextureTable& textures, MaterialId id) {
    MaterialWriter writer{textures, {}};
    GltfSurface& surface = writer.surface;
    surface.uv_sets.emplace_back();
    const Material& material = scene[id];
    surface.json["name"] = material.id;
    if (material.back || is_sheet(scene[material.front])) surface.json["doubleSided"] = true;
    std::visit([&](const auto& bsdf) { set_bsdf(writer, bsdf); }, scene[material.front]);
    if (!is_sheet(scene[material.front])) set_volume(writer);
    return std::move(surface);
}

void add_textures(GltfModel& model, GltfSurface& surface) {
    if (surface.textures.empty()) return;
    std::vector<int> indices;
    for (const GltfTexture& t : surface.textures) indices.push_back(add_texture(model, t));
    renumber_textures(surface.json, indices);
    surface.textures = {};
}

int add_material(GltfModel& model, const Scene& scene, const GltfSurface& surface,
                 const Shape& shape) {
    GltfJson json = surface.json;
    // glTF knows textures of emission, but not in another place than the shape's own: the mean.
    if (shape.emitter)
        set_emission(json, mean_radiance(scene, std::get<AreaEmitter>(scene[shape.emitter])));
    if (json.contains("extensions"))
        for (const auto& [name, extension] : json["extensions"].items())
            use_extension(model, name.c_str());
    return index_in(model, "materials", json);
}

}  // namespace burnish
