// An image in memory and the files that it comes from and goes to.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "burnish/image.h"
#include "core/pages.h"
#include "core/vec.h"

namespace burnish {

inline constexpr int kMaxImageSide = 32768;  ///< pixels
/// Whether a number of pixels may be a side of an image: whole, from 1 to kMaxImageSide.
inline bool is_side(double pixels) {
    return pixels >= 1 && pixels <= kMaxImageSide && pixels == std::floor(pixels);
}

/// width * height * channels of an image: those of 16384 x 8192 pixels with alpha.
inline constexpr std::size_t kMaxImageValues = std::size_t{1} << 29;
/// Pixels of an image of any channels.
inline constexpr std::size_t kMaxImagePixels = kMaxImageValues / 4;

/// Gives an image another shape and keeps its memory; the values are unspecified.
inline void reshape(Image& image, int width, int height, int channels) {
    image.width = width, image.height = height, image.channels = channels;
    const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                       static_cast<std::size_t>(channels);
    reserve_pages(count, image.values);
    image.values.resize(count);
}

/// A copy of a large image.
inline Image copy_of(const Image& image) {
    Image copy;
    reserve_pages(image.values.size(), copy.values);
    copy = image;
    return copy;
}

/// The image with 1 or 3 channels: the luminance of three, or one thrice.
Image with_channels(Image image, int channels);

/// Whether no value is infinite or NaN.
bool is_finite(const Image& image);

/// The image with a channel more: alpha, [height, width, 1], with which its colours are multiplied.
Image with_alpha(const Image& image, const Image& alpha);

/// The mean of two images of one shape.
Image mean_of(const Image& a, const Image& b);
/// The sum of the products of their values.
double dot(const Image& a, const Image& b);

/// How the numbers of a file are stored.
enum class PixelEncoding {
    kUnorm8,   ///< integers 0..255 that mean 0..1 (PNG 8 bit, JPEG, BMP, TGA)
    kUnorm16,  ///< integers 0..65535 that mean 0..1 (PNG 16 bit)
    kFloat,    ///< linear floating point (EXR, HDR, PFM)
};

/// A file as it was stored: integers scaled to [0, 1] but *not* sRGB-decoded; EXR, HDR and PFM
/// values as they are; not turned.
struct ImageFile {
    Image image;  ///< [height, width, 1 (gray) or 3 (RGB)]; colours are not multiplied with alpha
    PixelEncoding encoding = PixelEncoding::kFloat;
    const char* type = "";     ///< "PNG"
    int bits = 32;             ///< of a stored number
    Image alpha = {};          ///< [height, width, 1]; width 0: none is stored
    int orientation = 1;       ///< EXIF's, 1 to 8: how `oriented` puts it upright
    std::string profile = {};  ///< see Photograph
    bool says_linear = false;  ///< a PNG: its numbers are linear, by its gamma; it has no profile
    bool overscan = false;     ///< of an EXR: its data window is not its display window
    double chunk_bytes = 0;    ///< of an EXR's header: what reading takes beside file and image
};

/// Throws InputError, which names the file, where it holds more or less than the picture.
void require_no_overscan(const ImageFile& read, const std::string& file);

/// A picture turned and mirrored as an EXIF orientation says, 1 (as it is) to 8.
Image oriented(Image image, int orientation);

/// Reads PNG (8, 16 bit), JPEG, BMP, TGA, EXR (any compression), HDR, PFM; the format is told by
/// content. Throws InputError: missing, truncated, damaged, or larger than 32768 pixels a side /
/// 2^29 values.
ImageFile read_image_file(const std::filesystem::path& file);
/// What the header of such a file says: type, encoding, and an image without values, whose channels
/// count alpha. Reads no more than the file's start where that holds the header; no ReadLog
/// remembers it. Throws InputError as far as it looks.
ImageFile read_image_header(const std::filesystem::path& file);

/// write_image of burnish/image.h, whose PNG codes are linear where `srgb` is false.
void write_image(const std::filesystem::path& file, const Image& image, bool srgb);

/// A picture in the codes of a file of 8 bits: [height, width, channels].
struct CodedImage {
    int width = 0, height = 0, channels = 0;
    bool srgb = true;  ///< what the codes mean; otherwise they are linear
    std::vector<std::uint8_t> codes = {};
};

/// The code of a value, which is clamped to [0, 1] and, where `srgb`, encoded; of NaN that of 0.
std::uint8_t code_of(float value, bool srgb);

/// PNG bytes, for embedding. Throws InputError: no pixels, or not 1 to 4 channels.
std::string encode_png(const CodedImage& image);
/// Those of code_of each value.
std::string encode_png(const Image& image, bool srgb = true);

/// "350 x 350", for messages.
std::string size_text(int width, int height);

float srgb_to_linear(float encoded);
float linear_to_srgb(float linear);

}  // namespace burnish
