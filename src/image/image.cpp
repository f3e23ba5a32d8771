#include "image/image.h"

#include <bit>
#include <cstdint>

#include "core/dirty_blocks.h"
#include "core/parallel.h"

namespace burnish {

bool is_finite(const Image& image) {
    constexpr std::uint32_t kExponent = 0x7f800000;
    std::uint32_t count = 0;
    for (const float v : image.values)
        count += (std::bit_cast<std::uint32_t>(v) & kExponent) == kExponent;
    return count == 0;
}

Image with_channels(Image image, int channels) {
    if (image.channels == channels) return image;
    Image result = make_image(image.width, image.height, channels);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const float gray =
                image.channels == 1
                    ? image.at(x, y, 0)
                    : luminance(Rgbf{image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)});
            for (int c = 0; c < channels; ++c) result.at(x, y, c) = gray;
        }
    return result;
}

Image with_alpha(const Image& image, const Image& alpha) {
    Image result = make_image(image.width, image.height, image.channels + 1);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            for (int c = 0; c < image.channels; ++c) result.at(x, y, c) = image.at(x, y, c);
            result.at(x, y, image.channels) = alpha.at(x, y, 0);
        }
    return result;
}

Image oriented(Image image, int orientation) {
    if (orientation <= 1 || orientation > 8) return image;
    // Of the EXIF standard, tag 0x0112: which sides row 0 and column 0 of the file are.
    const bool transposed = orientation >= 5;
    const bool flips_x =
        orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
    const bool flips_y =
        orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
    Image upright = make_image(transposed ? image.height : image.width,
                               transposed ? image.width : image.height, image.channels);
    for (int y = 0; y < upright.height; ++y)
        for (int x = 0; x < upright.width; ++x) {
            const int sx = transposed ? y : x, sy = transposed ? x : y;
            const int from_x = flips_x ? image.width - 1 - sx : sx;
            const int from_y = flips_y ? image.height - 1 - sy : sy;
            for (int c = 0; c < image.channels; ++c)
                upright.at(x, y, c) = image.at(from_x, from_y, c);
        }
    return upright;
}

std::string size_text(int width, int height) {
    return std::to_string(width) + " x " + std::to_string(height);
}

Image mean_of(const Image& a, const Image& b) {
    Image mean = a;
    parallel_chunks(mean.values.size(), kParallelFloats, [&](std::size_t i, std::size_t end) {
        for (; i < end; ++i) mean.values[i] = 0.5f * (a.values[i] + b.values[i]);
    });
    return mean;
}

double dot(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i)
        sum += double{a.values[i]} * double{b.values[i]};
    return sum;
}

}  // namespace burnish
