#include "scene/constants.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "burnish/error.h"
#include "core/count_of.h"
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
        throw InputError(fmt::format("{}: found {} x {} texels of {}, expected at most {} values",
                                     sized.name, bitmap.width, bitmap.height,
                                     count_of(bitmap.channels, "channel"), kMaxImageValues));
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

/// Bitmaps and, behind them, constants as parameters. The texture of a constant is none of the
/// scene's; it is the same for all that are one number.
std::vector<Parameter> named_inputs(const Scene& scene) {
    std::vector<Parameter> all = scene.parameters;
    std::map<std::tuple<int, bool, int>, std::int32_t> textures;
    for (const ConstantParameter& c : scene.constants) {
        const auto next = static_cast<std::int32_t>(scene.textures.size() + all.size());
        all.push_back(
            {c.name,
             {c.element < 0 ? next : textures.try_emplace(number_of(c), next).first->second}});
    }
    return all;
}

NameMatch best_match(const std::vector<Parameter>& parameters, const std::string& name) {
    auto best = NameMatch::kNone;
    for (const Parameter& p : parameters) best = std::max(best, match_name(name, p.name));
    return best;
}

bool means_one_of(const std::vector<Parameter>& parameters, const std::string& name) {
    return best_match(parameters, name) != NameMatch::kNone;
}

/// named_inputs; constants that the scene does not give, which are of every material, have no name
/// where a short form fits others.
std::vector<Parameter> meant_inputs(const Scene& scene, const std::string& name) {
    std::vector<Parameter> all = named_inputs(scene);
    if (best_match(all, name) != NameMatch::kShortForm) return all;
    std::vector<Parameter> given = all;
    for (std::size_t i = 0; i < scene.constants.size(); ++i)
        if (!scene.constants[i].is_given) given[scene.parameters.size() + i].name.clear();
    return means_one_of(given, name) ? given : all;
}

/// Inputs that cannot be recovered, and why.
struct FixedInputs {
    std::vector<std::string> Scene::*names;
    const char* reason;
};
constexpr FixedInputs kFixedInputs[] = {
    {&Scene::attribute_inputs,
     "reads a mesh attribute, which cannot be recovered: expected a bitmap or a constant"},
    {&Scene::layer_inputs,
     "says which material or normal is shown, which cannot be recovered: expected an input of a "
     "BSDF, or a bitmap or a number that weighs two"},
    {&Scene::index_inputs, "says an index of refraction, which cannot be recovered"},
    {&Scene::absent_lobes,
     "is missing or 0 in the scene file, by which no light passes through: write another value "
     "there to recover it, but not within \"twosided\", which takes none"}};

/// None of the inputs that cannot be recovered is named better than the best one that can.
void require_recoverable(const Scene& scene, const std::string& name, NameMatch best) {
    for (const FixedInputs& fixed : kFixedInputs)
        for (const std::string& input : scene.*fixed.names)
            if (match_name(name, input) > best)
                throw InputError(fmt::format("{} {}", input, fixed.reason));
}

/// Where what precedes a colon means an input, what follows it is a size.
void require_size(const std::vector<Parameter>& inputs, const std::string& text) {
    const std::size_t at = text.rfind(':');
    if (at == std::string::npos || split_size(text).width > 0 || means_one_of(inputs, text)) return;
    if (means_one_of(inputs, text.substr(0, at)))
        throw InputError(
            fmt::format("{}: found the size '{}', expected texels a side, 1 to {}, as 512 or "
                        "512x256",
                        text, text.substr(at + 1), kMaxSide));
}

/// A bitmap keeps its size.
void require_same_size(const Scene& scene, const Parameter& parameter, const SizedName& sized,
                       const std::string& text) {
    const auto& bitmap = std::get<Bitmap>(scene[parameter.texture]);
    if (sized.width > 0 && (sized.width != bitmap.width || sized.height != bitmap.height))
        throw InputError(fmt::format("{}: {} is a bitmap of {} x {} texels: expected no other size",
                                     text, parameter.name, bitmap.width, bitmap.height));
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

SizedName split_size(const Scene& scene, const std::string& text) {
    return means_one_of(named_inputs(scene), text) ? SizedName{text} : split_size(text);
}

bool means_input(const Scene& scene, const std::string& text) {
    const std::vector<Parameter> inputs = named_inputs(scene);
    return means_one_of(inputs, text) || means_one_of(inputs, split_size(text).name);
}

NamedInput find_input(const Scene& scene, const std::string& name) {
    const std::vector<Parameter> inputs = meant_inputs(scene, name);
    require_recoverable(scene, name, best_match(inputs, name));
    const std::size_t found = find_parameter(inputs, name), bitmaps = scene.parameters.size();
    return found < bitmaps ? NamedInput{found, false} : NamedInput{found - bitmaps, true};
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
    require_size(named_inputs(scene), text);
    const SizedName sized = split_size(scene, text);
    const NamedInput found = find_input(scene, sized.name);
    if (found.is_constant) return free_constant(scene, scene.constants[found.index], sized);
    require_same_size(scene, scene.parameters[found.index], sized, text);
    return found.index;
}

}  // namespace burnish
