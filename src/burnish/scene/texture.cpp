#include "burnish/scene/texture.h"

#include <algorithm>
#include <utility>

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
    const Image colors = linear_image(bitmap);
    std::vector<float> values;
    for (std::size_t i = 0; i < colors.values.size(); i += 3)
        values.push_back(
            luminance(Rgbf{colors.values[i], colors.values[i + 1], colors.values[i + 2]}));
    bitmap.codes.clear();
    bitmap.values = std::move(values), bitmap.channels = 1;
}

void replace_texels(Bitmap& bitmap, const Image& texels) {
    bitmap.width = texels.width, bitmap.height = texels.height;
    bitmap.codes.clear();
    bitmap.values = texels.values;
}

}  // namespace burnish
