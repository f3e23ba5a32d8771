// An image in memory.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace burnish {

/// Pixels [height, width, channels], row 0 on top, channel fastest. Linear unless said otherwise.
struct Image {
    int width = 0, height = 0, channels = 0;
    std::vector<float> values = {};

    float& at(int x, int y, int c) { return values[index(x, y) + static_cast<std::size_t>(c)]; }
    float at(int x, int y, int c) const {
        return values[index(x, y) + static_cast<std::size_t>(c)];
    }
    /// Of the first channel of a pixel, in `values`.
    std::size_t index(int x, int y) const {
        return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(x)) *
               static_cast<std::size_t>(channels);
    }
    friend bool operator==(const Image&, const Image&) = default;
};

inline Image make_image(int width, int height, int channels, float value = 0.0f) {
    return {width, height, channels,
            std::vector<float>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                                   static_cast<std::size_t>(channels),
                               value)};
}

/// An image that several hold together: copies of what holds it do not copy the pixels, which
/// nobody may change.
using SharedImage = std::shared_ptr<const Image>;
inline SharedImage share(Image image) { return std::make_shared<const Image>(std::move(image)); }

/// Reads PNG, JPEG, BMP, TGA, EXR, HDR or PFM, told by content, as linear values: integer formats
/// are sRGB-decoded, and a JPEG is turned as its EXIF orientation says. One or three channels;
/// alpha is dropped. Throws InputError: missing, truncated, damaged, of a kind that is not known or
/// not supported, larger than 32768 pixels a side, or of more than 536,870,912 values.
Image read_image(const std::string& file);

/// Writes linear values by extension: .exr (32-bit float), .pfm, .png (8 bit, sRGB). The file
/// appears whole or not at all. Throws InputError: another extension, an image without pixels,
/// larger than 32768 pixels a side or without one value for each channel, of more than 536,870,912
/// values or 4 channels, or with alpha (2 or 4) in .pfm; OutputError where the file cannot be
/// written.
void write_image(const std::string& file, const Image& image);

}  // namespace burnish
