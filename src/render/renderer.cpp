#include "render/renderer.h"

#include <fmt/format.h>

#include <algorithm>

#include "burnish/error.h"
#include "core/count_of.h"
#include "core/require.h"
#include "image/image.h"
#include "image/whole.h"
#include "render/render.h"
#include "render/view.h"
#include "scene/blends.h"
#include "scene/constants.h"
#include "scene/parameter_names.h"

namespace burnish {

Renderer make_renderer(LoadedScene loaded, LightSelection selection) {
    separate_parts(loaded.scene);
    auto scene = std::make_shared<const LoadedScene>(std::move(loaded));
    TracedScene traced = prepare(scene->scene, selection);
    return Renderer(
        std::make_shared<const RendererData>(RendererData{std::move(scene), std::move(traced)}));
}

TextureId find_texture(const Scene& scene, const std::string& parameter) {
    const SizedName sized = split_size(scene, parameter);
    const NamedInput found = find_input(scene, sized.name);
    if (found.is_constant) {
        const std::string& name = scene.constants[found.index].name;
        throw InputError(fmt::format(
            "{}{} is a constant: expected a renderer that was loaded with {} among its constants",
            parameter == name ? "" : parameter + ": ", name, sized.width > 0 ? parameter : "it"));
    }
    require(
        sized.width == 0,
        parameter + ": expected no size, which is for constants that a renderer is loaded with");
    return scene.parameters[found.index].texture;
}

std::vector<TextureId> find_textures(const Scene& scene,
                                     const std::vector<std::string>& parameters) {
    std::vector<TextureId> textures;
    for (const std::string& name : parameters) textures.push_back(find_texture(scene, name));
    require_distinct(parameters, textures);
    return textures;
}

std::vector<TextureId> find_textures(const Scene& scene, const TextureValues& values) {
    std::vector<std::string> names;
    for (const auto& entry : values) names.push_back(entry.first);
    return find_textures(scene, names);
}

std::vector<TextureId> find_replaced(const Scene& scene, const TextureValues& values) {
    const std::vector<TextureId> textures = find_textures(scene, values);
    std::size_t next = 0;
    for (const auto& entry : values)
        require(!is_of_emitter(scene, textures[next++]),
                entry.first + " is a texture that an emitter reads, too: expected one of its own");
    return textures;
}

Image texels_of(const Bitmap& bitmap, const std::string& parameter, const Image& image) {
    require_whole(image, parameter);
    require_finite(image, parameter);
    if (image.width == bitmap.width && image.height == bitmap.height &&
        (image.channels == 1 || image.channels == 3))
        return with_channels(image, bitmap.channels);
    const auto text = [](int width, int height, int channels) {
        return size_text(width, height) + " texels of " + count_of(channels, "channel");
    };
    throw InputError(parameter + ": found " + text(image.width, image.height, image.channels) +
                     ", expected " + text(bitmap.width, bitmap.height, bitmap.channels));
}

ReplacedTextures replace_textures(const Scene& scene, const TextureValues& values) {
    ReplacedTextures replaced{{},
                              {scene.textures, std::vector<const float*>(scene.textures.size())}};
    const std::vector<TextureId> textures = find_textures(scene, values);
    std::size_t next = 0;
    for (const auto& [name, image] : values) {
        const TextureId id = textures[next++];
        replaced.images.push_back(texels_of(std::get<Bitmap>(scene[id]), name, image));
        replaced.table.values[static_cast<std::size_t>(id.value)] =
            replaced.images.back().values.data();
    }
    return replaced;
}

Renderer Renderer::load(const std::string& file, const SceneSettings& settings) {
    if (std::min(settings.width, settings.height) > 0 &&
        std::max(settings.width, settings.height) > kMaxImageSide)
        throw InputError(fmt::format("the film has {} x {} pixels: expected at most {} a side",
                                     settings.width, settings.height, kMaxImageSide));
    LoadOptions options;
    options.definitions = settings.definitions;
    options.width = settings.width, options.height = settings.height;
    options.ignore_unsupported = settings.ignore_unsupported;
    LoadedScene loaded = load_scene(file, options);
    for (const std::string& constant : settings.constants)
        require_parameter(loaded.scene, constant);
    return make_renderer(std::move(loaded), settings.light_selection);
}

int Renderer::width() const { return data_->traced.film.crop_width; }
int Renderer::height() const { return data_->traced.film.crop_height; }

Renderer Renderer::with_camera(const ViewCamera& camera) const {
    return Renderer(std::make_shared<const RendererData>(
        RendererData{data_->loaded, through(data_->traced, camera)}));
}

Renderer Renderer::with_lighting(const Lighting& lighting) const {
    return Renderer(std::make_shared<const RendererData>(
        RendererData{data_->loaded, under(data_->traced, lighting)}));
}

std::vector<ParameterInfo> Renderer::parameters() const {
    std::vector<ParameterInfo> infos;
    for (const Parameter& p : data_->scene().parameters) {
        const auto& bitmap = std::get<Bitmap>(data_->scene()[p.texture]);
        infos.push_back({p.name, bitmap.width, bitmap.height, bitmap.channels});
    }
    return infos;
}

const std::vector<std::string>& Renderer::warnings() const { return data_->loaded->warnings; }

Image Renderer::texture(const std::string& parameter) const {
    const Scene& scene = data_->scene();
    return linear_image(std::get<Bitmap>(scene[find_texture(scene, parameter)]));
}

Image Renderer::render(std::uint32_t samples_per_pixel, std::uint32_t seed,
                       const TextureValues& textures, const Progress& progress) const {
    if (samples_per_pixel == 0 || samples_per_pixel > kMaxSamplesPerPixel)
        throw InputError(fmt::format("samples per pixel are {}: expected at least 1, at most {}",
                                     samples_per_pixel, kMaxSamplesPerPixel));
    find_replaced(data_->scene(), textures);
    const ReplacedTextures replaced = replace_textures(data_->scene(), textures);
    const TraceInput input{
        .scene = &data_->traced, .textures = &replaced.table, .key = {seed, Stream::kImage}};
    RenderCounts counts;
    Image picture = burnish::render(input, 0, samples_per_pixel, &counts, progress);
    constexpr const char* kReason = "values of the scene or of the textures are too large";
    const std::size_t samples = picture.values.size() / 3 * samples_per_pixel;
    require_few_rejected(std::min(counts.rejected, samples), samples, "samples", kReason);
    require_finite(picture, "the picture", kReason);
    return picture;
}

}  // namespace burnish
