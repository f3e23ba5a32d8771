// Textures: what a BSDF parameter reads at a texture coordinate.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/vec.h"
#include "image/image.h"

namespace burnish {

enum class TextureFilter { kNearest, kBilinear };
enum class TextureWrap { kRepeat, kMirror, kClamp };

/// uv' = M uv, applied before the wrap: the rows [m00 m01 m02], [m10 m11 m12].
struct UvTransform {
    std::array<float, 6> m{1, 0, 0, 0, 1, 0};
};

/// Mitsuba's `bitmap`. Texel (x, y) has its centre at ((x + 1/2) / width, (y + 1/2) / height); row
/// 0 is v = 0. The texels are either 8-bit codes with a decoding table (a quarter of the memory
/// traffic), or floats.
struct Bitmap {
    int width = 0, height = 0, channels = 0;  ///< channels 1 or 3
    std::vector<std::uint8_t> codes;  ///< [height, width, channels]; empty where `values` is used
    std::array<float, 256> decode{};  ///< code -> linear value
    std::vector<float> values;  ///< [height, width, channels], linear; empty where `codes` is used
    TextureFilter filter = TextureFilter::kBilinear;
    TextureWrap wrap = TextureWrap::kRepeat;
    UvTransform to_uv;
    bool raw = false;  ///< the scene's flag: the file holds values, not sRGB codes
    /// Made of a mesh attribute: it holds three or four texels for each triangle of one mesh, whose
    /// Mesh::lookup_uvs find them, and cannot be an unknown.
    bool is_attribute = false;
    std::string file;  ///< as written in the scene, for messages
};

/// Mitsuba's `checkerboard`: color0 where floor-parity of 2 uv' agrees, color1 elsewhere.
struct Checkerboard {
    Rgbf color0{0.4f, 0.4f, 0.4f}, color1{0.2f, 0.2f, 0.2f};
    UvTransform to_uv;
};

/// To add a kind: a struct above and its place in this variant. The compiler then names what lacks:
/// scene/texture.cpp, the look-up in shading/texture.h and models/gltf_picture.cpp. Only its reader
/// in mitsuba/textures.cpp is not named.
using Texture = std::variant<Bitmap, Checkerboard>;

/// The bitmap, or null for textures without texels: only those with texels can be optimised.
const Bitmap* bitmap_of(const Texture& texture);

/// Mean of the absolute values of its colours, where it is a bitmap over all texels.
Rgbf mean_magnitude(const Texture& texture);

/// All texels as linear floats [height, width, channels].
Image linear_image(const Bitmap& bitmap);

/// The luminance takes the place of three channels, as it is for whoever reads numbers.
void keep_luminance(Bitmap& bitmap);

/// Linear texels of any size, with 1 or 3 channels, take the place of the bitmap's own.
void replace_texels(Bitmap& bitmap, const Image& texels);

}  // namespace burnish
