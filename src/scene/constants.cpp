#include "scene/constants.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "burnish/error.h"
#include "core/parsed.h"
#include "image/image.h"
#include "scene/parameter_names.h"

namespace burnish {

namespace {

constexpr int kMaxSide = 16384;

/// A side of a texture, 1 to kMaxSide; 0: the text is none.
int side_of(std::string_view text) {
    const int side = parsed<int>(text).value_or(0);
    return side >= 1 && side <= kMaxSide ? side : 0;
}

/// Of constants that are one number of the scene file, where they have an element.
std::tuple<int, bool, int> number_of(const ConstantParameter& c) {
    return {c.element, bool(c.blend), c.input};
}

bool is_one_number(const ConstantParameter& a, const ConstantParameter& b) {
    return a.element < 0 ? &a == &b : number_of(a) == number_of(b);
}

/// Those that are one number of the scene file with a constant of the scene's.
std::vector<ConstantParameter> one_number(const Scene& scene, const ConstantParameter& constant) {
    std::vector<ConstantParameter> all;
    for (const ConstantParameter& c : scene.constants)
        if (is_one_number(c, constant)) all.push_back(c);
    return all;
}

/// Whether a material shows what a constant is of.
bool shows(const Scene& scene, MaterialId material, const ConstantParameter& constant) {
    if (constant.blend) return is_in(scene, constant.blend, material);
    const auto shown = bsdfs_of(scene, material);
    return std::find(shown.begin(), shown.end(), constant.bsdf) != shown.end();
}

/// The shapes that show what a constant is of know where on a texture they are.
void require_coordinates(const Scene& scene, const ConstantParameter& constant) {
    const std::string& name = constant.name;
    for (const Shape& shape : scene.shapes) {
        if (!shape.material || !shows(scene, shape.material, constant)) continue;
        const Mesh* mesh = shown_mesh(scene, shape);
        if (mesh && !mesh->lookup_uvs.empty())
            throw InputError(fmt::format(
                "{}: the shape '{}' reads a mesh attribute, beside which no texture has "
                "coordinates: expected no size, for one value",
                name, shape.id));
        if (mesh && mesh->uvs.empty())
            throw InputError(
                fmt::format("{}: the shape '{}' has no texture coordinates: expected some, or no "
                            "size, for one value",
                            name, shape.id));
    }
}

/// "mat.metallic.value" as Mitsuba calls it once it is a bitmap.
std::string as_bitmap(const std::string& name) { return name.substr(0, name.rfind('.')) + ".data"; }

/// Its place reads a texture from now on.
void give_texture(Scene& scene, const ConstantParameter& constant, TextureId texture) {
    if (constant.blend)
        scene.materials[static_cast<std::size_t>(constant.blend.value)].blend->weight.texture =
            texture;
    else
        set_texture(scene.bsdfs[static_cast<std::size_t>(constant.bsdf.value)], constant.input,
                    texture);
}

std::size_t free_constant(Scene& scene, const ConstantParameter& constant, const SizedName& sized) {
    const std::vector<ConstantParameter> all = one_number(scene, constant);
    Bitmap bitmap;
    const Image value = value_of(scene, constant);
    bitmap.width = std::max(1, sized.width), bitmap.height = std::max(1, sized.height);
    bitmap.channels = value.channels;
    const bool is_one = bitmap.width == 1 && bitmap.height == 1;
    const auto texels =
        static_cast<std::size_t>(bitmap.width) * static_cast<std::size_t>(bitmap.height);
    if (texels * static_cast<std::size_t>(bitmap.channels) > kMaxImageValues)
        throw InputError(
            fmt::format("{}: found {} x {} texels of {} channels, expected at most {} values",
                        sized.name, bitmap.width, bitmap.height, bitmap.channels, kMaxImageValues));
    for (const ConstantParameter& c : all)
        if (!is_one) require_coordinates(scene, c);
    if (is_one) bitmap.filter = TextureFilter::kNearest;
    bitmap.raw = value.channels == 1;
    for (std::size_t i = 0; i < texels; ++i)
        bitmap.values.insert(bitmap.values.end(), value.values.begin(), value.values.end());
    const TextureId id{static_cast<std::int32_t>(scene.textures.size())};
    scene.textures.push_back(std::move(bitmap));
    const std::size_t parameter = scene.parameters.size();
    for (const ConstantParameter& c : all) {
        give_texture(scene, c, id);
        const std::string name = is_one ? c.name : as_bitmap(c.name);
        if (scene.parameters.size() == parameter || scene.parameters.back().name != name)
            scene.parameters.push_back({name, id});
        std::erase_if(scene.constants,
                      [&](const ConstantParameter& other) { return other.name == c.name; });
    }
    return parameter;
}

/// Constants as parameters: their texture is the first that is one number with them.
std::vector<Parameter> listed(const std::vector<ConstantParameter>& constants) {
    std::vector<Parameter> all;
    std::map<std::tuple<int, bool, int>, std::int32_t> indices;
    for (const ConstantParameter& c : constants) {
        const auto index = static_cast<std::int32_t>(all.size());
        all.push_back(
            {c.name,
             {c.element < 0 ? index : indices.try_emplace(number_of(c), index).first->second}});
    }
    return all;
}

bool means_one_of(const std::vector<Parameter>& parameters, const std::string& name) {
    return std::any_of(parameters.begin(), parameters.end(), [&](const Parameter& p) {
        return p.name == name || is_short_form(name, p.name);
    });
}

/// Where what precedes a colon means a parameter, what follows it is a size.
void require_size(const std::vector<Parameter>& parameters, const std::vector<Parameter>& constants,
                  const std::string& text) {
    const std::size_t at = text.rfind(':');
    if (at == std::string::npos || split_size(text).width > 0) return;
    const std::string name = text.substr(0, at);
    if (means_one_of(constants, text)) return;
    if (means_one_of(parameters, name) || means_one_of(constants, name))
        throw InputError(
            fmt::format("{}: found the size '{}', expected texels a side, 1 to {}, as 512 or "
                        "512x256",
                        text, text.substr(at + 1), kMaxSide));
}

}  // namespace

SizedName split_size(const std::string& text) {
    const std::size_t at = text.rfind(':');
    if (at == std::string::npos) return {text};
    const std::string size = text.substr(at + 1);
    const std::size_t cross = size.find('x');
    const int width = side_of(std::string_view(size).substr(0, cross));
    const int height =
        cross == std::string::npos ? width : side_of(std::string_view(size).substr(cross + 1));
    if (width == 0 || height == 0) return {text};
    return {text.substr(0, at), width, height};
}

const ConstantParameter* constant_of(const Scene& scene, const std::string& name) {
    if (means_one_of(scene.parameters, name)) return nullptr;
    const ConstantParameter* found = nullptr;
    for (const ConstantParameter& c : scene.constants) {
        if (c.name == name) return &c;
        if (!is_short_form(name, c.name)) continue;
        if (found && !is_one_number(*found, c)) return nullptr;
        if (!found) found = &c;
    }
    return found;
}

Image value_of(const Scene& scene, const ConstantParameter& constant) {
    if (constant.blend) return {1, 1, 1, {scene[constant.blend].blend->weight.constant}};
    const Bsdf& bsdf = scene[constant.bsdf];
    if (const ScalarInput* scalar = scalar_at(bsdf, constant.input))
        return {1, 1, 1, {scalar->constant}};
    const Rgbf& color = color_at(bsdf, constant.input)->constant;
    return {1, 1, 3, {color.x, color.y, color.z}};
}

std::size_t require_parameter(Scene& scene, const std::string& text) {
    const SizedName sized =
        means_one_of(scene.parameters, text) ? SizedName{text} : split_size(text);
    if (means_one_of(scene.parameters, sized.name)) {
        const std::size_t found = find_parameter(scene.parameters, sized.name);
        const auto& bitmap = std::get<Bitmap>(scene[scene.parameters[found].texture]);
        if (sized.width > 0 && (sized.width != bitmap.width || sized.height != bitmap.height))
            throw InputError(
                fmt::format("{}: {} is a bitmap of {} x {} texels: expected no other size", text,
                            scene.parameters[found].name, bitmap.width, bitmap.height));
        return found;
    }
    for (const std::string& name : scene.attribute_inputs)
        if (is_short_form(sized.name, name))
            throw InputError(fmt::format(
                "{}: {} reads a mesh attribute, which cannot be recovered: expected a bitmap or a "
                "constant",
                text, name));
    for (const std::string& name : scene.layer_inputs)
        if (name == sized.name || is_short_form(sized.name, name))
            throw InputError(fmt::format(
                "{}: {} says which material or normal is shown, which cannot be recovered: "
                "expected an input of a BSDF, or a bitmap or a number that weighs two",
                text, name));
    for (const std::string& name : scene.fixed_inputs)
        if (is_short_form(sized.name, name))
            throw InputError(fmt::format(
                "{}: {} cannot be recovered: expected another input of a BSDF", text, name));
    const std::vector<Parameter> constants = listed(scene.constants);
    require_size(scene.parameters, constants, text);
    if (means_one_of(constants, sized.name))
        return free_constant(scene, scene.constants[find_parameter(constants, sized.name)], sized);
    std::vector<Parameter> all = scene.parameters;
    all.insert(all.end(), constants.begin(), constants.end());
    return find_parameter(all, sized.name);  // says which names are near
}

}  // namespace burnish
