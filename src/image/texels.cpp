#include "image/texels.h"

#include <algorithm>

#include "core/vec.h"

namespace burnish {

Image padded_to(Image image, int width, int height) {
    if (image.width >= width && image.height >= height) return image;
    Image padded =
        make_image(std::max(image.width, width), std::max(image.height, height), image.channels);
    for (int y = 0; y < padded.height; ++y)
        for (int x = 0; x < padded.width; ++x)
            for (int c = 0; c < padded.channels; ++c)
                padded.at(x, y, c) =
                    image.at(std::min(x, image.width - 1), std::min(y, image.height - 1), c);
    return padded;
}

std::size_t drop_negative(Image& image) {
    std::size_t dropped = 0;
    for (std::size_t i = 0; i < image.values.size(); i += 3) {
        float* const c = &image.values[i];
        if (!(luminance(Rgbf{c[0], c[1], c[2]}) < 0)) continue;
        c[0] = c[1] = c[2] = 0;
        ++dropped;
    }
    return dropped;
}

}  // namespace burnish
