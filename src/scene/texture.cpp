#include "scene/texture.h"

#include <algorithm>

namespace burnish {

Image linear_image(const Bitmap& bitmap) {
    Image image{bitmap.width, bitmap.height, bitmap.channels, bitmap.values};
    if (bitmap.codes.empty()) return image;
    image.values.resize(bitmap.codes.size());
    std::transform(bitmap.codes.begin(), bitmap.codes.end(), image.values.begin(),
                   [&](std::uint8_t code) { return bitmap.decode[code]; });
    return image;
}

void keep_luminance(Bitmap& bitmap) {
    if (bitmap.channels == 1) return;
    replace_texels(bitmap, with_channels(linear_image(bitmap), 1));
}

void replace_texels(Bitmap& bitmap, const Image& texels) {
    bitmap.width = texels.width, bitmap.height = texels.height, bitmap.channels = texels.channels;
    bitmap.codes.clear();
    bitmap.values = texels.values;
}

}  // namespace burnish
