#include "mitsuba/bsdf_reader.h"

#include <fmt/format.h>

#include "mitsuba/colors.h"

namespace burnish::mitsuba {

namespace {

void add_parameter(BsdfReader& reader, const Property& property, TextureId texture) {
    add_texture_parameter(reader.loader, reader.properties, property,
                          fmt::format("{}.{}.data", reader.id, property.name), texture);
}

/// property: null where the file does not give it.
void add_constant(BsdfReader& reader, const std::string& name, int input,
                  const Property* property) {
    reader.constants.push_back(
        {fmt::format("{}.{}.value", reader.id, name), {}, input, property != nullptr});
}

void warn_outside(BsdfReader& reader, const Property& property, float value, float max) {
    if (!(value >= 0 && value <= max))
        log_warning(reader.loader, property.site->place,
                    fmt::format("the parameter \"{}\" is {}, expected a value in [0, {}]",
                                property.name, value, max));
}

}  // namespace

bool add_texture_parameter(Loader& loader, const Properties& properties, const Property& property,
                           const std::string& name, TextureId texture) {
    Scene& scene = loader.result.scene;
    const Bitmap* bitmap = bitmap_of(scene[texture]);
    if (!bitmap) return false;
    if (bitmap->is_attribute)
        scene.attribute_inputs.push_back(name);
    else
        loader.parameters.push_back(
            {property.site->order,
             {name, texture},
             {properties.node->order, property.name, property.node->order}});
    return true;
}

ColorInput take_color_input(BsdfReader& reader, const std::string& name, int place,
                            ColorInput input) {
    const Property* property = take(reader.properties, name);
    if (property && is_texture(*property)) {
        input.texture = load_texture(reader.loader, *property->node);
        add_parameter(reader, *property, input.texture);
        return input;
    }
    add_constant(reader, name, place, property);
    if (!property) return input;
    input.constant = read_color(*property);
    for (int c = 0; c < 3; ++c)
        if (!(input.constant[c] >= 0 && input.constant[c] <= 1))
            fail(property->site->place,
                 fmt::format("the reflectance \"{}\" has the value {}, expected values in [0, 1]",
                             name, input.constant[c]));
    return input;
}

ScalarReading take_scalar_input(BsdfReader& reader, const std::string& name, int place,
                                float fallback, TextureUse use) {
    ScalarReading reading{{fallback, {}}, fallback != 0};
    const Property* property = take(reader.properties, name);
    const bool has_texture = property && is_texture(*property);
    if (!has_texture) add_constant(reader, name, place, property);
    if (!property) return reading;
    if (has_texture) {
        reading.input.texture = load_texture(reader.loader, *property->node, use);
        add_parameter(reader, *property, reading.input.texture);
        return {reading.input, true};
    }
    reading.input.constant = mean(read_color(*property));
    warn_outside(reader, *property, reading.input.constant, max_of(use));
    const std::string& tag = property->node->tag;
    return {reading.input, (tag != "float" && tag != "integer") || reading.input.constant != 0};
}

}  // namespace burnish::mitsuba
