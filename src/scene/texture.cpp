#include "scene/texture.h"

#include <algorithm>
#include <cmath>

#include "core/contract.h"
#include "core/variant.h"

namespace burnish {

const Bitmap* bitmap_of(const Texture& texture) {
    return match(
        texture, [](const Bitmap& bitmap) { return &bitmap; },
        [](const Checkerboard&) -> const Bitmap* { return nullptr; });
}

Rgbf mean_magnitude(const Texture& texture) {
    const auto magnitude = [](const Rgbf& c) {
        return Rgbf{std::abs(c.x), std::abs(c.y), std::abs(c.z)};
    };
    return match(
        texture,
        [](const Bitmap& bitmap) {
            const Image texels = linear_image(bitmap);
            const auto channels = static_cast<std::size_t>(texels.channels);
            std::array<double, 3> sum{};
            for (std::size_t i = 0; i < texels.values.size(); ++i)
                sum[i % channels] += double{std::abs(texels.values[i])};
            if (channels == 1) sum[1] = sum[2] = sum[0];
            const double count = static_cast<double>(texels.values.size() / channels);
            return Rgbf{static_cast<float>(sum[0] / count), static_cast<float>(sum[1] / count),
                        static_cast<float>(sum[2] / count)};
        },
        [&](const Checkerboard& board) {
            return (magnitude(board.color0) + magnitude(board.color1)) * 0.5f;
        });
}

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
    BURNISH_REQUIRE(texels.channels == 1 || texels.channels == 3, ==, true);
    BURNISH_REQUIRE(texels.values.size(), ==,
                    static_cast<std::size_t>(texels.width) *
                        static_cast<std::size_t>(texels.height) *
                        static_cast<std::size_t>(texels.channels));
    bitmap.width = texels.width, bitmap.height = texels.height, bitmap.channels = texels.channels;
    bitmap.codes.clear();
    bitmap.values = texels.values;
}

}  // namespace burnish
