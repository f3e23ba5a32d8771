// Emitters: area, envmap, constant, point, spot, directional, projector.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "image/texels.h"
#include "mitsuba/colors.h"
#include "mitsuba/loader.h"
#include "mitsuba/transforms.h"

namespace burnish::mitsuba {

namespace {

constexpr const char* kUnsupportedEmitters =
    "directionalarea sky sun sunsky timed_sunsky volumelight";

/// Linear RGB of the spectrum that is 1 at every wavelength: an emitted <spectrum> is turned into
/// RGB through the CIE curves, and sRGB's white is not equal-energy white. (A reflectance, and a
/// <float>, are not.)
constexpr Rgbf kEqualEnergyWhite{1.204794f, 0.948291f, 0.908916f};

/// Refuses light that single precision cannot hold. what: as in "\"radiance\"".
Rgbf finite_emission(const Properties& properties, const std::string& what, const Rgbf& value) {
    if (!is_finite(value))
        fail(properties.node->place, fmt::format("{} is ({}, {}, {}), expected finite numbers",
                                                 what, value.x, value.y, value.z));
    return value;
}

Rgbf take_emission(Properties& properties, const char* name) {
    const Property* property = take(properties, name);
    Rgbf value = property ? read_color(*property, SpectrumUse::kEmission) : Rgbf{1, 1, 1};
    if (property && is_uniform_spectrum(*property)) value = value * kEqualEnergyWhite;
    if (value.x < 0 || value.y < 0 || value.z < 0)
        fail(properties.node->place,
             fmt::format("\"{}\" is ({}, {}, {}), expected no negative value", name, value.x,
                         value.y, value.z));
    return finite_emission(properties, fmt::format("\"{}\"", name), value);
}

/// A colour, or a texture of colours, times 1.
struct Emission {
    Rgbf color{1, 1, 1};
    TextureId texture;
};

Emission take_textured_emission(Loader& loader, Properties& properties, const char* name) {
    const Property* property = take(properties, name);
    if (!property || !is_texture(*property)) return {take_emission(properties, name), {}};
    return {{1, 1, 1}, load_texture(loader, *property->node, TextureUse::kAny)};
}

/// Bytes are at most 1.
float brightest_texel(const Texture& texture) {
    if (const auto* board = std::get_if<Checkerboard>(&texture))
        return std::max(max_component(board->color0), max_component(board->color1));
    const std::vector<float>& values = std::get<Bitmap>(texture).values;
    return values.empty() ? 1 : *std::max_element(values.begin(), values.end());
}

/// Refuses a factor that is, times the brightest texel of its texture, not finite.
Rgbf finite_emission(const Loader& loader, const Properties& properties, const std::string& what,
                     const Rgbf& factor, TextureId texture) {
    const float max = texture ? brightest_texel(loader.result.scene[texture]) : 1;
    finite_emission(properties, what, factor * max);
    return factor;
}

void set_environment(Loader& loader, const Node& node) {
    if (loader.environment)
        fail(node.place,
             fmt::format("found a second environment emitter (first at {}), expected at most one",
                         place_text(loader.environment->place)));
    loader.environment = &node;
}

EnvironmentEmitter read_environment(Loader& loader, Properties& properties) {
    const Node& node = *properties.node;
    set_environment(loader, node);
    const std::string name = take_file_name(properties);
    EnvironmentEmitter emitter;
    emitter.scale = take_float(properties, "scale", 1.0f);
    if (emitter.scale < 0)
        fail(node.place, fmt::format("\"scale\" is {}, expected no negative value", emitter.scale));
    const Transform to_world = take_transform(properties, "to_world").value_or(Transform{});
    if (!uniform_scale(to_world, 1e-3).uniform)
        fail(node.place, "\"to_world\" of the envmap scales or shears, expected a rotation");
    emitter.to_world = orthonormalised(to_world);
    for (int i = 0; i < 3; ++i) emitter.to_world(i, 3) = 0;  // infinitely far away
    ignore(properties, {"mis_compensation"});                // only how Mitsuba samples it

    ImageFile file = load_image(loader, node.place, name);
    if (file.encoding != PixelEncoding::kFloat)
        for (float& v : file.image.values) v = srgb_to_linear(v);
    replace_non_finite(loader, node.place, name, file.image.values);
    Image sky = with_channels(padded_to(std::move(file.image), 2, kEnvironmentRows), 3);
    const std::size_t dropped = drop_negative(sky);
    const float max = *std::max_element(sky.values.begin(), sky.values.end()) * emitter.scale;
    finite_emission(properties, "the brightest texel times \"scale\"", {max, max, max});
    loader.kept += static_cast<double>(sky.values.size() * sizeof(float));
    emitter.image = share(std::move(sky));
    if (dropped > 0)
        note(loader, node.place,
             fmt::format("\"{}\" has {} texels of negative luminance: read as black", name,
                         dropped));
    return emitter;
}

ConstantEmitter read_constant(Loader& loader, Properties& properties) {
    const Rgbf radiance = take_emission(properties, "radiance");
    set_environment(loader, *properties.node);  // only one that is read
    return {radiance};
}

PointEmitter read_point(Properties& properties) {
    const auto position = take_point(properties, "position");
    const auto to_world = take_transform(properties, "to_world");
    if (position && to_world)
        fail(properties.node->place,
             "found both \"position\" and \"to_world\", expected at most one of them");
    const Vec3<double> place =
        to_world ? column_of(*to_world, 3) : position.value_or(Vec3<double>{});
    require_reach(properties.node->place, "light", place);
    PointEmitter emitter;
    emitter.position = to_float(place);
    emitter.intensity = take_emission(properties, "intensity");
    return emitter;
}

/// Where a light stands, and the scale of its axes.
struct LightPlace {
    Transform to_world;  ///< rigid
    float scale = 1;
};

LightPlace take_light_place(Properties& properties) {
    const Transform to_world = take_transform(properties, "to_world").value_or(Transform{});
    const UniformScale scale = uniform_scale(to_world, 1e-3);
    if (!scale.uniform)
        fail(properties.node->place,
             fmt::format("\"to_world\" of the {} shears or scales its axes differently, expected a "
                         "rotation and translation",
                         properties.type));
    require_reach(properties.node->place, "light", column_of(to_world, 3));
    return {orthonormalised(to_world), static_cast<float>(scale.scale)};
}

SpotEmitter read_spot(Loader& loader, Properties& properties) {
    SpotEmitter spot;
    spot.to_world = take_light_place(properties).to_world;  // a cone is the same at any scale
    spot.intensity = take_emission(properties, "intensity");
    spot.cutoff = take_float(properties, "cutoff_angle", 20);
    spot.beam_width = take_float(properties, "beam_width", 0.75f * spot.cutoff);
    const Emission texture = take_textured_emission(loader, properties, "texture");
    spot.texture = texture.texture;
    spot.intensity = finite_emission(loader, properties, "\"intensity\" times \"texture\"",
                                     spot.intensity * texture.color, spot.texture);
    const float largest = spot.texture ? 89.9f : 180.0f;
    if (!(spot.cutoff > 0 && spot.cutoff <= largest && spot.beam_width >= 0))
        fail(properties.node->place,
             fmt::format(
                 "\"beam_width\" is {} and \"cutoff_angle\" {}, expected 0 <= beam_width and "
                 "0 < cutoff_angle <= {}",
                 spot.beam_width, spot.cutoff, largest));
    spot.beam_width = std::min(spot.beam_width, spot.cutoff);  // a wider beam is full, as Mitsuba's
    return spot;
}

DirectionalEmitter read_directional(Properties& properties) {
    const auto direction = take_point(properties, "direction");
    const auto to_world = take_transform(properties, "to_world");
    if (direction && to_world)
        fail(properties.node->place,
             "found both \"direction\" and \"to_world\", expected at most one of them");
    Vec3<double> way = direction.value_or(Vec3<double>{0, 0, 1});
    if (to_world) way = column_of(*to_world, 2);
    if (!(length(way) > 0))
        fail(properties.node->place,
             "the direction of the light is 0, expected one to shine along");
    // As in Mitsuba, where the length that to_world gives the direction counts as a cosine does.
    const auto scale = static_cast<float>(to_world ? length(way) : 1);
    return {to_float(normalize(way)),
            finite_emission(properties, "\"irradiance\" times the scale of \"to_world\"",
                            take_emission(properties, "irradiance") * scale)};
}

ProjectorEmitter read_projector(Loader& loader, Properties& properties) {
    ProjectorEmitter projector;
    const LightPlace place = take_light_place(properties);
    projector.to_world = place.to_world;
    const Emission emission = take_textured_emission(loader, properties, "irradiance");
    const float scale = take_float(properties, "scale", 1);
    if (scale < 0)
        fail(properties.node->place,
             fmt::format("\"scale\" is {}, expected no negative value", scale));
    // As in Mitsuba, where the length that to_world gives the axes counts as a brightness does.
    projector.texture = emission.texture;
    projector.irradiance = finite_emission(
        loader, properties, "\"irradiance\" times \"scale\" and that of \"to_world\"",
        emission.color * (scale * place.scale), projector.texture);
    if (emission.texture)
        if (const Bitmap* bitmap = bitmap_of(loader.result.scene[emission.texture]))
            projector.aspect = static_cast<double>(bitmap->width) / bitmap->height;
    projector.fov_x = take_fov_x(loader, properties, projector.aspect);
    return projector;
}

Emitter read_emitter(Loader& loader, Properties& properties) {
    if (properties.type == "envmap") return read_environment(loader, properties);
    if (properties.type == "constant") return read_constant(loader, properties);
    if (properties.type == "point") return read_point(properties);
    if (properties.type == "area")
        fail(properties.node->place, "emitter \"area\" stands alone, expected it inside a shape");
    if (properties.type == "spot") return read_spot(loader, properties);
    if (properties.type == "directional") return read_directional(properties);
    if (properties.type == "projector") return read_projector(loader, properties);
    fail_plugin(*properties.node, kUnsupportedEmitters,
                "\"area\", \"envmap\", \"constant\", \"point\", \"spot\", \"directional\" or "
                "\"projector\"");
}

}  // namespace

void load_emitter(Loader& loader, const Node& node) {
    Properties properties = open_properties(loader.document, node);
    ignore(properties, {"sampling_weight"});
    Scene& scene = loader.result.scene;
    const Emitter emitter = read_emitter(loader, properties);
    scene.emitter_ids.push_back(
        id_or_made_up(loader, node, fmt::format("emitter_{}", scene.emitters.size())));
    scene.emitters.push_back(emitter);
    warn_unknown(properties, loader.result.warnings);
}

AreaEmitter load_area_emitter(Loader& loader, const Node& node, ShapeId shape) {
    Properties properties = open_properties(loader.document, node);
    if (properties.type == "directionalarea") fail_plugin(node, kUnsupportedEmitters, "\"area\"");
    if (properties.type != "area")
        fail(node.place, fmt::format("found the emitter \"{}\" inside a shape, expected \"area\"",
                                     properties.type));
    if (const Property* to_world = take(properties, "to_world"))
        fail(to_world->site->place, "found \"to_world\" inside \"area\", expected it in the shape");
    ignore(properties, {"sampling_weight"});
    const Emission emission = take_textured_emission(loader, properties, "radiance");
    const AreaEmitter emitter{
        finite_emission(loader, properties, "\"radiance\"", emission.color, emission.texture),
        shape, emission.texture};
    warn_unknown(properties, loader.result.warnings);
    return emitter;
}

}  // namespace burnish::mitsuba
