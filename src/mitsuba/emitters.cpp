// Emitters: area, envmap, constant, point.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "mitsuba/loader.h"
#include "mitsuba/transforms.h"

namespace burnish::mitsuba {

namespace {

constexpr const char* kUnsupported =
    "directional directionalarea projector spot sunsky timed_sunsky";

/// Linear RGB of the spectrum that is 1 at every wavelength: an emitted <spectrum> is turned into
/// RGB through the CIE curves, and sRGB's white is not equal-energy white. (A reflectance, and a
/// <float>, are not.)
constexpr Rgbf kEqualEnergyWhite{1.204794f, 0.948291f, 0.908916f};

Rgbf take_emission(Properties& properties, const char* name) {
    const Property* property = take(properties, name);
    Rgbf value = property ? read_color(*property) : Rgbf{1, 1, 1};
    if (property && property->node->tag == "spectrum") value = value * kEqualEnergyWhite;
    if (value.x < 0 || value.y < 0 || value.z < 0)
        fail(properties.node->place,
             fmt::format("\"{}\" is ({}, {}, {}), expected no negative value", name, value.x,
                         value.y, value.z));
    return value;
}

void set_environment(Loader& loader, const Node& node) {
    if (loader.environment)
        fail(node.place,
             fmt::format(
                 "found a second environment emitter (first at {}:{}:{}), expected at most one",
                 loader.environment->place.file, loader.environment->place.line,
                 loader.environment->place.column));
    loader.environment = &node;
}

Image to_rgb(Image image) {
    if (image.channels == 3) return image;
    Image rgb = make_image(image.width, image.height, 3);
    for (std::size_t i = 0; i < image.values.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) rgb.values[3 * i + c] = image.values[i];
    return rgb;
}

/// A colour outside the gamut stays (Mitsuba keeps it); a texel of negative luminance emits
/// nothing, since it cannot be sampled.
void drop_negative(Loader& loader, const Place& place, const std::string& name, Image& image) {
    std::size_t dropped = 0;
    for (std::size_t i = 0; i < image.values.size(); i += 3) {
        float* const c = &image.values[i];
        if (!(luminance(Rgbf{c[0], c[1], c[2]}) < 0)) continue;
        c[0] = c[1] = c[2] = 0;
        ++dropped;
    }
    if (dropped > 0)
        note(loader, place,
             fmt::format("\"{}\" has {} texels of negative luminance: read as black", name,
                         dropped));
}

EnvironmentEmitter read_environment(Loader& loader, Properties& properties) {
    const Node& node = *properties.node;
    set_environment(loader, node);
    const std::string name = take_string(properties, "filename", "");
    if (name.empty()) fail(node.place, "emitter \"envmap\" lacks the parameter \"filename\"");
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
    emitter.image = to_rgb(padded_to_two(std::move(file.image)));
    drop_negative(loader, node.place, name, emitter.image);
    return emitter;
}

ConstantEmitter read_constant(Loader& loader, Properties& properties) {
    set_environment(loader, *properties.node);
    return {take_emission(properties, "radiance")};
}

PointEmitter read_point(Properties& properties) {
    const auto position = take_point(properties, "position");
    const auto to_world = take_transform(properties, "to_world");
    if (position && to_world)
        fail(properties.node->place,
             "found both \"position\" and \"to_world\", expected at most one of them");
    PointEmitter emitter;
    if (position)
        emitter.position = {static_cast<float>(position->x), static_cast<float>(position->y),
                            static_cast<float>(position->z)};
    if (to_world) emitter.position = transform_point(*to_world, {0, 0, 0});
    emitter.intensity = take_emission(properties, "intensity");
    return emitter;
}

Emitter read_emitter(Loader& loader, Properties& properties) {
    if (properties.type == "envmap") return read_environment(loader, properties);
    if (properties.type == "constant") return read_constant(loader, properties);
    if (properties.type == "point") return read_point(properties);
    if (properties.type == "area")
        fail(properties.node->place, "emitter \"area\" stands alone, expected it inside a shape");
    fail_plugin(*properties.node, kUnsupported, "\"area\", \"envmap\", \"constant\" or \"point\"");
}

}  // namespace

void load_emitter(Loader& loader, const Node& node) {
    Properties properties = open_properties(loader.document, node);
    ignore(properties, {"sampling_weight"});
    Scene& scene = loader.result.scene;
    const std::string id = attribute(node, "id");
    scene.emitter_ids.push_back(id.empty() ? fmt::format("emitter_{}", scene.emitters.size()) : id);
    scene.emitters.push_back(read_emitter(loader, properties));
    warn_unknown(properties, loader.result.warnings);
}

AreaEmitter load_area_emitter(Loader& loader, const Node& node, ShapeId shape) {
    Properties properties = open_properties(loader.document, node);
    if (properties.type != "area")
        fail(node.place, fmt::format("found the emitter \"{}\" inside a shape, expected \"area\"",
                                     properties.type));
    if (const Property* to_world = take(properties, "to_world"))
        fail(to_world->site->place, "found \"to_world\" inside \"area\", expected it in the shape");
    ignore(properties, {"sampling_weight"});
    const AreaEmitter emitter{take_emission(properties, "radiance"), shape};
    warn_unknown(properties, loader.result.warnings);
    return emitter;
}

}  // namespace burnish::mitsuba
