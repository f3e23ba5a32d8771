#include "mitsuba/colors.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "image/image.h"
#include "mitsuba/numbers.h"

namespace burnish::mitsuba {

namespace {

/// A type and the names of its parameters.
struct ColorPlugin {
    std::string_view type, parameters;
};

constexpr std::array<ColorPlugin, 4> kColorPlugins{{
    {"uniform", "\"value\", \"wavelength_min\" or \"wavelength_max\""},
    {"srgb", "\"color\" or \"unbounded\""},
    {"rawconstant", "\"value\""},
    {"d65", "\"color\" or \"scale\""},
}};

const ColorPlugin* plugin_of(const Node& node) {
    if (node.tag != "spectrum" && node.tag != "texture") return nullptr;
    const auto* found =
        std::find_if(kColorPlugins.begin(), kColorPlugins.end(),
                     [&](const ColorPlugin& p) { return p.type == attribute(node, "type"); });
    return found == kColorPlugins.end() ? nullptr : found;
}

Rgbf gray(float value) { return {value, value, value}; }

Rgbf read_rgb(const Property& property) {
    expect_tag(property, {"rgb"});
    return read_color(property);
}

Rgbf read_srgb(Properties& properties) {
    const Property& property = take_required(properties, "color");
    const Rgbf color = read_rgb(property);
    const bool unbounded = take_boolean(properties, "unbounded", false);
    for (int c = 0; c < 3; ++c)
        if (!unbounded && !(color[c] >= 0 && color[c] <= 1))
            fail(
                property.site->place,
                fmt::format("the \"color\" of \"srgb\" has the value {}, expected values in [0, 1]",
                            color[c]));
    return color;
}

Rgbf read_raw(Properties& properties) {
    const std::string& tag = take_required(properties, "value").node->tag;
    if (tag != "vector" && tag != "point") return gray(take_float(properties, "value", 0));
    return to_float(*take_point(properties, "value"));
}

Rgbf read_daylight(Properties& properties) {
    const Property* color = take(properties, "color");
    return (color ? read_rgb(*color) : gray(1)) * take_float(properties, "scale", 1);
}

Rgbf read_uniform(Properties& properties) {
    take_required(properties, "value");
    ignore(properties, {"wavelength_min", "wavelength_max"});
    return gray(take_float(properties, "value", 0));
}

Rgbf color_of(Properties& properties) {
    if (properties.type == "uniform") return read_uniform(properties);
    if (properties.type == "srgb") return read_srgb(properties);
    if (properties.type == "rawconstant") return read_raw(properties);
    return read_daylight(properties);
}

/// As Mitsuba's rgb variants have it.
Rgbf read_color_plugin(const Node& node) {
    Properties properties{&node, attribute(node, "type"), {}};
    for (const Node& child : node.children)
        properties.all.push_back({attribute(child, "name"), &child, &child, false});
    const Rgbf color = color_of(properties);
    for (const Property& property : properties.all)
        if (!property.taken)
            fail(property.site->place,
                 fmt::format("found the parameter \"{}\" of {} \"{}\", expected {}", property.name,
                             node.tag, properties.type, plugin_of(node)->parameters));
    return color;
}

float decode_srgb(double v) { return srgb_to_linear(static_cast<float>(v)); }

/// "#f9c400", as old files write sRGB colours.
Rgbf parse_hex_color(const std::string& text, const Place& place) {
    unsigned code = 0;
    const char* const end = text.data() + text.size();
    const auto result = std::from_chars(text.data() + 1, end, code, 16);
    if (text.size() != 7 || result.ec != std::errc() || result.ptr != end)
        fail(place,
             fmt::format("found the colour \"{:.40}\", expected one such as \"#f9c400\"", text));
    const auto channel = [&](unsigned shift) {
        return decode_srgb(((code >> shift) & 255) / 255.0);
    };
    return {channel(16), channel(8), channel(0)};
}

/// A <spectrum> of a type that is no colour.
[[noreturn]] void fail_spectrum(const Node& node) {
    const std::string& type = attribute(node, "type");
    if (type == "blackbody" || type == "regular" || type == "irregular")
        fail_unsupported(node.place,
                         fmt::format("spectrum \"{}\" has no meaning in RGB, as in Mitsuba's rgb "
                                     "variants: expected <rgb>, or a <spectrum> whose value is "
                                     "one number or pairs such as \"400:0.1, 500:0.7\"",
                                     type));
    fail_plugin(node, "", "\"uniform\", \"srgb\", \"rawconstant\", \"d65\" or a value");
}

}  // namespace

bool is_color_plugin(const Node& node) { return plugin_of(node) != nullptr; }

bool is_uniform_spectrum(const Property& property) {
    return property.node->tag == "spectrum" && attribute(*property.node, "type").empty() &&
           attribute(*property.node, "value").find(':') == std::string::npos;
}

bool is_texture(const Property& property) {
    return property.node->tag == "texture" && !is_color_plugin(*property.node);
}

Rgbf read_color(const Property& property, SpectrumUse use) {
    const Node& node = *property.node;
    const Place& place = property.site->place;
    if (is_color_plugin(node)) return read_color_plugin(node);
    if (node.tag == "texture")
        fail_unsupported(
            place,
            fmt::format("the parameter \"{}\" as a texture is not supported yet: expected <rgb>",
                        property.name));
    expect_tag(property, {"rgb", "srgb", "spectrum", "float", "integer"});
    if (node.tag == "spectrum" && !attribute(node, "type").empty()) fail_spectrum(node);
    const std::string& text = attribute(node, "value");
    if (node.tag == "srgb" && text.starts_with('#')) return parse_hex_color(text, place);
    if (node.tag == "rgb" && text.starts_with('#'))
        fail(place, fmt::format("found the colour \"{0:.40}\" in <rgb>, expected <srgb "
                                "value=\"{0:.40}\"/> or linear numbers",
                                text));
    if (node.tag == "spectrum" && !is_uniform_spectrum(property))
        return rgb_of_spectrum(text, use, place);
    const std::vector<double> v = parse_numbers(text, place);
    if (v.size() != 1 && !(v.size() == 3 && (node.tag == "rgb" || node.tag == "srgb")))
        fail(place,
             fmt::format("the parameter \"{}\" has {} numbers, expected {}", property.name,
                         v.size(), node.tag == "rgb" || node.tag == "srgb" ? "1 or 3" : "1"));
    const Vec3<double> c =
        v.size() == 3 ? Vec3<double>{v[0], v[1], v[2]} : Vec3<double>{v[0], v[0], v[0]};
    if (node.tag == "srgb") return {decode_srgb(c.x), decode_srgb(c.y), decode_srgb(c.z)};
    return to_float(c);
}

Rgbf take_color(Properties& properties, const std::string& name, const Rgbf& fallback,
                SpectrumUse use) {
    const Property* property = take(properties, name);
    return property ? read_color(*property, use) : fallback;
}

}  // namespace burnish::mitsuba
