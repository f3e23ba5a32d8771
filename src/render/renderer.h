// What a Renderer holds.
#pragma once

#include "burnish/renderer.h"
#include "mitsuba/load.h"
#include "paths/trace.h"

namespace burnish {

/// What an image takes at most, and an evaluation.
inline constexpr std::uint32_t kMaxSamplesPerPixel = 1 << 20;

struct RendererData {
    std::shared_ptr<const LoadedScene> loaded;  ///< traced refers to it; views share it
    TracedScene traced;

    const Scene& scene() const { return loaded->scene; }
};

/// Builds what rays need of a scene that was read or made otherwise.
Renderer make_renderer(LoadedScene loaded, LightSelection selection = LightSelection::kUniform);
inline Renderer make_renderer(Scene scene) {
    return make_renderer(LoadedScene{std::move(scene), {}, {}});
}

/// The texture that a name means. Throws InputError: none or several.
TextureId find_texture(const Scene& scene, const std::string& parameter);
/// Those of several names. Throws InputError, too, where two names mean one.
std::vector<TextureId> find_textures(const Scene& scene,
                                     const std::vector<std::string>& parameters);
std::vector<TextureId> find_textures(const Scene& scene, const TextureValues& values);
/// Those of textures that can be replaced where light is traced. Throws InputError, too, of one
/// that an emitter reads: lights stay as they were.
std::vector<TextureId> find_replaced(const Scene& scene, const TextureValues& values);

/// The scene's textures with some replaced. Throws InputError as find_textures does, and of texels
/// of another size.
struct ReplacedTextures {
    std::vector<Image> images;
    TextureTable table;  ///< points into `images` and the scene
};
ReplacedTextures replace_textures(const Scene& scene, const TextureValues& values);

/// An image as the texels of a bitmap: with its channels. Throws InputError, which names the
/// parameter, where the sizes differ or a value is not finite.
Image texels_of(const Bitmap& bitmap, const std::string& parameter, const Image& image);

}  // namespace burnish
