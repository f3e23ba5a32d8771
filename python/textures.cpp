// Textures by name, as they are given in the place of the scene's.
#include <cmath>
#include <map>

#include "burnish/error.h"
#include "image/image.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "render/renderer.h"

namespace burnish::python {

ParameterInfo texture_info(const Renderer& renderer, const std::string& name) {
    const Scene& scene = renderer.data().scene();
    const auto& bitmap = std::get<Bitmap>(scene[find_texture(scene, name)]);
    return {name, bitmap.width, bitmap.height, bitmap.channels};
}

namespace {

/// Leaves out what says nothing new, so that all of Renderer.parameters can be given: a second name
/// of one texture with the values of the first, and the scene's own values of a texture that an
/// emitter reads, too.
void leave_out_repeated(const Renderer& renderer, TextureValues& values) {
    const Scene& scene = renderer.data().scene();
    std::map<std::int32_t, const Image*> firsts;
    for (auto at = values.begin(); at != values.end();) {
        const auto& [name, image] = *at;
        const TextureId id = find_texture(scene, name);
        bool is_known = is_of_emitter(scene, id) && image == renderer.texture(name);
        if (!is_known) {
            const auto [first, is_new] = firsts.try_emplace(id.value, &image);
            is_known = !is_new && image == *first->second;
        }
        at = is_known ? values.erase(at) : std::next(at);
    }
}

}  // namespace

TextureValues to_textures(nb::handle textures, const Renderer& renderer) {
    TextureValues values;
    if (textures.is_none()) return values;
    if (!nb::hasattr(textures, "items"))
        throw type_error("textures: expected a mapping of names to arrays, found " +
                         type_of(textures));
    for (const nb::handle item : textures.attr("items")()) {
        const std::string name = text_of(nb::object(item[0]));
        const nb::object value = item[1];
        if (const auto number = as_number(value, name)) {
            if (!std::isfinite(*number))
                throw InputError(name + ": found " + repr_of(value) + ", expected a finite number");
            const ParameterInfo info = texture_info(renderer, name);
            values[name] =
                make_image(info.width, info.height, info.channels, static_cast<float>(*number));
        } else {
            values[name] = to_image(value, name);
        }
    }
    leave_out_repeated(renderer, values);
    return values;
}

}  // namespace burnish::python
