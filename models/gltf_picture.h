// Pictures of colours that depend on textures, for glTF.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "image/image.h"
#include "scene/scene.h"
#include "shading/texture.h"

namespace burnish {

/// The raster that a picture is computed on.
struct Raster {
    UvTransform to_uv;
    int width = 2, height = 2;
    TextureFilter filter = TextureFilter::kNearest;
    TextureWrap wrap = TextureWrap::kRepeat;
};

/// None for a constant, which a texture of one texel is as well.
std::optional<Raster> raster_of(const TextureTable& table, TextureId id);

/// That of the texture whose to_uv repeats it least often, of equals the first: the others lie in
/// it whole. It is as fine as the finest of them there, up to 4096 texels on a side, or what the
/// largest has. None without textures.
std::optional<Raster> joint_raster(const TextureTable& table, const std::vector<TextureId>& read);

/// Linear RGB at coordinates before a texture's own transform.
using ColorAt = std::function<Rgbf(const Vec2f& uv)>;

/// The largest channel at the centre of any texel.
float largest_of(const Raster& raster, const ColorAt& color);

/// The colour at the centre of each texel, in codes of sRGB or linear ones: three channels.
CodedImage picture_of(const Raster& raster, bool srgb, const ColorAt& color);

}  // namespace burnish
