#include "cli/blender_script.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "image/files.h"
#include "mitsuba/write.h"
#include "shading/conductor.h"

namespace burnish {

namespace {

using ScriptJson = nlohmann::ordered_json;

constexpr const char* kBefore =
    R"(# Makes Blender materials of the recovered textures, in Blender 4 or newer:
#   blender --python import_into_blender.py      or open it in the text editor and run it.
# A material of the same name is changed where it is; else a new one is made, and a single new one goes onto the selected
# meshes. model.glb, beside this file, brings meshes and materials in one step.
import os

import bpy

# True where v runs downwards in the mesh's file, as in the PLY files that most Mitsuba scenes name; False for a mesh
# that was given to `burnish new`.
FLIP_V = False

# Of each material the inputs of its Principled BSDF: a value, or a texture, whose colours are multiplied by "times" and
# whose numbers become (scale x + offset) ** power. to_uv is applied to coordinates whose v runs downwards.
MATERIALS = )";

constexpr const char* kAfter = R"(

def folder():
    text = getattr(bpy.context.space_data, "text", None)
    file = bpy.path.abspath(text.filepath) if text else __file__
    return os.path.dirname(os.path.abspath(file))


def math(tree, operation, a, b):
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    tree.links.new(a, node.inputs[0])
    node.inputs[1].default_value = b
    return node.outputs[0]


def multiplied(tree, color, factors):
    node = tree.nodes.new("ShaderNodeVectorMath")
    node.operation = "MULTIPLY"
    tree.links.new(color, node.inputs[0])
    node.inputs[1].default_value = factors
    return node.outputs["Vector"]


def affine(tree, uv, a, b, c):
    """a u + b v + c"""
    node = tree.nodes.new("ShaderNodeVectorMath")
    node.operation = "DOT_PRODUCT"
    tree.links.new(uv, node.inputs[0])
    node.inputs[1].default_value = (a, b, 0)
    return math(tree, "ADD", node.outputs["Value"], c)


def coordinates(tree, to_uv):
    """In Blender v runs upwards: both ends of to_uv are turned around."""
    uv = tree.nodes.new("ShaderNodeTexCoord").outputs["UV"]
    (a, b, c), (d, e, f) = to_uv[:3], to_uv[3:]
    if not FLIP_V:
        b, c, e, f = -b, b + c, -e, e + f
    combined = tree.nodes.new("ShaderNodeCombineXYZ")
    tree.links.new(affine(tree, uv, a, b, c), combined.inputs["X"])
    tree.links.new(affine(tree, uv, -d, -e, 1 - f), combined.inputs["Y"])
    return combined.outputs["Vector"]


def image(file, color_space):
    """One for each colour space that a file is read in: Blender's image has one."""
    path = os.path.normpath(os.path.join(folder(), file))
    for known in bpy.data.images:
        known_path = os.path.normpath(bpy.path.abspath(known.filepath))
        if known_path == path and known.colorspace_settings.name == color_space:
            return known
    new = bpy.data.images.load(path)
    new.colorspace_settings.name = color_space
    return new


def texture(tree, t):
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image(t["file"], t["color_space"])
    node.interpolation, node.extension = t["interpolation"], t["extension"]
    if FLIP_V or t["to_uv"] != [1, 0, 0, 0, 1, 0]:
        tree.links.new(coordinates(tree, t["to_uv"]), node.inputs["Vector"])
    out = node.outputs["Color"]
    if "times" in t:
        out = multiplied(tree, out, t["times"])
    for operation, key, neutral in (("MULTIPLY", "scale", 1), ("ADD", "offset", 0), ("POWER", "power", 1)):
        if t.get(key, neutral) != neutral:
            out = math(tree, operation, out, t[key])
    return out


def fill(material, inputs):
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    bsdf = tree.nodes.new("ShaderNodeBsdfPrincipled")
    tree.links.new(bsdf.outputs["BSDF"], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    for name, value in inputs.items():
        if isinstance(value, dict):
            tree.links.new(texture(tree, value), bsdf.inputs[name])
        else:
            bsdf.inputs[name].default_value = value
    if inputs.get("Anisotropic", 0) != 0:  # along u; without a tangent, around the object's z
        tangent = tree.nodes.new("ShaderNodeTangent")
        tangent.direction_type = "UV_MAP"
        tree.links.new(tangent.outputs["Tangent"], bsdf.inputs["Tangent"])


def found(name, taken):
    """The material of that name, which Blender 5 cuts to 255 bytes of UTF-8 and Blender 4 to 63."""
    for max_bytes in (None, 255, 63):
        material = bpy.data.materials.get(name.encode()[:max_bytes].decode(errors="ignore"))
        if material is not None and material not in taken:
            return material
    return None


taken, new = [], []
for name, inputs in MATERIALS.items():
    material = found(name, taken)
    if material is None:
        material = bpy.data.materials.new(name)
        new.append(material)
    taken.append(material)
    fill(material, inputs)
if len(new) == 1:
    for thing in bpy.context.selected_objects:
        if thing.type == "MESH":
            thing.data.materials.clear()
            thing.data.materials.append(new[0])
)";

/// A scalar of `principled` in Blender: (scale x + offset) ^ power.
struct BlenderInput {
    PrincipledScalar scalar;
    const char* socket;
    double scale = 1, offset = 0, power = 1;
};
constexpr std::array kBlenderInputs{
    BlenderInput{PrincipledScalar::kRoughness, "Roughness"},
    BlenderInput{PrincipledScalar::kMetallic, "Metallic"},
    BlenderInput{PrincipledScalar::kAnisotropic, "Anisotropic"},
    BlenderInput{PrincipledScalar::kSheen, "Sheen Weight"},
    BlenderInput{PrincipledScalar::kSpecTrans, "Transmission Weight"},
    // Mitsuba's lobe is a quarter of its weight; its alpha is 0.1 - 0.099 gloss.
    BlenderInput{PrincipledScalar::kClearcoat, "Coat Weight", 0.25},
    BlenderInput{PrincipledScalar::kClearcoatGloss, "Coat Roughness", -0.099, 0.1, 0.5},
};

/// A bitmap in a file, which is relative to the script.
ScriptJson texture_json(const Bitmap& bitmap, const std::string& file, bool color) {
    const std::string format = lower_extension(file);
    const bool linear = bitmap.raw || format == ".exr" || format == ".hdr";
    const char* extension = bitmap.wrap == TextureWrap::kRepeat   ? "REPEAT"
                            : bitmap.wrap == TextureWrap::kMirror ? "MIRROR"
                                                                  : "EXTEND";
    ScriptJson to_uv = ScriptJson::array();
    for (const float x : bitmap.to_uv.m) to_uv.push_back(few_digits(x));
    return {{"file", file},
            {"color_space", !linear ? "sRGB"
                            : color ? "Linear Rec.709"
                                    : "Non-Color"},
            {"interpolation", bitmap.filter == TextureFilter::kNearest ? "Closest" : "Linear"},
            {"extension", extension},
            {"to_uv", to_uv}};
}

/// What a script has of one material.
struct ScriptMaterial {
    const LoadedScene& loaded;
    const RunResult& run;
    bool has_scene;  ///< files in scene/
    ScriptJson inputs = ScriptJson::object();
};

/// Whether any of its inputs was, also one that Blender has no socket for.
bool is_recovered(const Scene& scene, MaterialId material, const RunResult& run) {
    const std::vector<TextureId> textures = textures_of(scene, material);
    return std::ranges::any_of(run.textures, [&](const TargetTexture& t) {
        return std::ranges::count(textures, t.texture) > 0;
    });
}

/// The single texel of a constant, as a colour with alpha or as a number.
ScriptJson value_json(const Image& texels, bool color) {
    if (!color) return few_digits(texels.values[0]);
    ScriptJson rgba = ScriptJson::array();
    for (int c = 0; c < 3; ++c)
        rgba.push_back(few_digits(texels.at(0, 0, texels.channels == 3 ? c : 0)));
    rgba.push_back(1);
    return rgba;
}

/// The recovered texture, or the scene's, of which scene/ has a copy; null for one without texels,
/// without a copy, or in PFM, which Blender does not read.
ScriptJson texture_of(const ScriptMaterial& m, TextureId id, bool color) {
    const Scene& scene = m.loaded.scene;
    const Bitmap* bitmap = bitmap_of(scene[id]);
    if (!bitmap) return {};
    for (std::size_t i = 0; i < m.run.textures.size(); ++i) {
        const TargetTexture& t = m.run.textures[i];
        if (t.texture != id) continue;
        const Image& texels = m.run.result.summary.textures[i].values;
        if (is_one_value(texels)) return value_json(texels, color);
        return texture_json(*bitmap, texture_file(t, ".exr"), color);
    }
    for (std::size_t i = 0; m.has_scene && i < scene.parameters.size(); ++i) {
        if (scene.parameters[i].texture != id) continue;
        const std::string file = file_of(m.loaded.source, m.loaded.source.parameters[i]);
        if (lower_extension(file) == ".pfm") return {};
        return texture_json(*bitmap, "scene/" + file, color);
    }
    return {};
}

constexpr Rgbf kNoFactors{1, 1, 1};

void add_color(ScriptMaterial& m, const ColorInput& input, const Rgbf& times = kNoFactors) {
    const Rgbf& c = input.constant;
    ScriptJson value =
        input.texture ? texture_of(m, input.texture, true)
                      : ScriptJson::array({few_digits(c.x), few_digits(c.y), few_digits(c.z), 1});
    if (value.is_null()) return;
    if (times != kNoFactors && value.is_array()) {
        for (int i = 0; i < 3; ++i) {
            ScriptJson& channel = value[static_cast<std::size_t>(i)];
            channel = few_digits(channel.get<float>() * times[i]);
        }
    } else if (times != kNoFactors) {
        value["times"] =
            ScriptJson::array({few_digits(times.x), few_digits(times.y), few_digits(times.z)});
    }
    m.inputs["Base Color"] = value;
}

/// A value is clamped to [0, 1], as in model.glb.
void add_scalar(ScriptMaterial& m, const ScalarInput& input, const BlenderInput& to) {
    ScriptJson value = input.texture ? texture_of(m, input.texture, false)
                                     : ScriptJson(few_digits(input.constant));
    if (value.is_number()) {
        const double x = std::clamp(value.get<double>(), 0.0, 1.0);
        value = std::pow(to.scale * x + to.offset, to.power);
    } else if (!value.is_null()) {
        value["scale"] = to.scale;
        value["offset"] = to.offset;
        value["power"] = to.power;
    }
    if (!value.is_null()) m.inputs[to.socket] = value;
}

void add_inputs(ScriptMaterial& m, const Diffuse& diffuse) {
    add_color(m, diffuse.reflectance);
    m.inputs["Roughness"] = 1.0;
    m.inputs["Specular IOR Level"] = 0.0;
}

void add_inputs(ScriptMaterial& m, const Principled& p) {
    add_color(m, p.base_color);
    for (BlenderInput to : kBlenderInputs) {
        // Mitsuba's sheen is of the part that is no metal. A texture of metal is left out.
        const auto metallic = m.inputs.find("Metallic");
        if (to.scalar == PrincipledScalar::kSheen && metallic != m.inputs.end() &&
            metallic->is_number())
            to.scale = 1 - metallic->get<double>();
        add_scalar(m, p[to.scalar], to);
    }
    m.inputs["IOR"] = few_digits(p.eta);
}

void set_constants(ScriptMaterial& m, double roughness, double metallic, float eta) {
    m.inputs["Roughness"] = roughness;
    m.inputs["Metallic"] = metallic;
    if (metallic == 0) m.inputs["IOR"] = few_digits(eta);
}

/// A metal's colour is its reflectance at normal incidence, times that of the surface; its alpha is
/// the square of a roughness.
void add_metal(ScriptMaterial& m, const ColorInput& reflectance, const MetalIndex& index) {
    add_color(m, reflectance, fresnel_conductor(1.0f, index.eta, index.k));
    set_constants(m, 0, 1, 1);
}
void add_inputs(ScriptMaterial& m, const Conductor& b) { add_metal(m, b.reflectance, b.index); }
void add_inputs(ScriptMaterial& m, const RoughConductor& b) {
    add_metal(m, b.reflectance, b.index);
    add_scalar(m, b.roughness.alpha[0], {PrincipledScalar::kRoughness, "Roughness", 1, 0, 0.5});
}
void add_inputs(ScriptMaterial& m, const Plastic& b) {
    add_color(m, b.colors[0]);
    set_constants(m, 0, 0, b.eta);
}
void add_inputs(ScriptMaterial& m, const RoughPlastic& b) {
    add_color(m, b.colors[0]);
    set_constants(m, std::sqrt(double{b.alpha}), 0, b.eta);
}
void add_inputs(ScriptMaterial& m, const Dielectric& b) {
    add_color(m, b.colors[1]);
    set_constants(m, 0, 0, b.eta);
    m.inputs["Transmission Weight"] = 1.0;
}
void add_inputs(ScriptMaterial& m, const RoughDielectric& b) {
    add_color(m, b.colors[1]);
    set_constants(m, 0, 0, b.eta);
    m.inputs["Transmission Weight"] = 1.0;
    add_scalar(m, b.roughness.alpha[0], {PrincipledScalar::kRoughness, "Roughness", 1, 0, 0.5});
}
void add_inputs(ScriptMaterial& m, const PrincipledThin& b) {
    add_color(m, b.base_color);
    set_constants(m, 0, 0, b.eta);
    const auto add = [&](ThinScalar s, const char* socket) {
        add_scalar(m, b.scalars[static_cast<std::size_t>(s)],
                   {PrincipledScalar::kRoughness, socket});
    };
    add(ThinScalar::kRoughness, "Roughness"), add(ThinScalar::kAnisotropic, "Anisotropic");
    add(ThinScalar::kSpecTrans, "Transmission Weight"), add(ThinScalar::kSheen, "Sheen Weight");
}

}  // namespace

std::string blender_script(const LoadedScene& loaded, const RunResult& run, bool has_scene) {
    const Scene& scene = loaded.scene;
    ScriptJson materials = ScriptJson::object();
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const MaterialId id{static_cast<std::int32_t>(i)};
        if (!is_recovered(scene, id, run)) continue;
        ScriptMaterial m{loaded, run, has_scene};
        std::visit([&](const auto& bsdf) { add_inputs(m, bsdf); }, scene[scene[id].front]);
        materials[scene[id].id] = m.inputs;
    }
    // In UTF-8: what JSON escapes by two surrogates is no character in Python.
    return kBefore + materials.dump(4, ' ', false, ScriptJson::error_handler_t::replace) + "\n" +
           kAfter;
}

}  // namespace burnish
