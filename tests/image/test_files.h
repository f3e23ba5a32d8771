// Image files of every kind as bytes, written here by other means than the readers under test use.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "image/image.h"

namespace burnish::test_files {

/// width x height x channels of values in [0, 1], smooth, different in every channel.
Image smooth_image(int width, int height, int channels);

/// Appends four bytes, the lowest first.
void put32(std::string& bytes, std::uint32_t v);

struct PngLayout {
    int width = 13, height = 9;
    int color_type = 2;  ///< as in the PNG specification: 0 gray, 2 RGB, 3 palette, 4 gray and
                         ///< alpha, 6 RGB and alpha
    int bits = 8;
    bool interlaced = false;
    std::string text = {};     ///< a compressed one, before the pixels
    std::string profile = {};  ///< an ICC profile
    double gamma = 0;          ///< the exponent that the numbers are encoded with; 0: not said
    std::vector<double> chromaticities = {};  ///< x and y of white, red, green and blue; or none
};
/// The header and the name of an ICC profile, in ASCII as of version 2 or in UTF-16 as of
/// version 4.
std::string make_profile(const std::string& name, int version);
/// Samples are sample(x, y, c) of png_sample; a palette has the colours of png_palette.
std::string make_png(const PngLayout& layout);
int png_sample(const PngLayout& layout, int x, int y, int channel);
int png_palette(int index, int channel);

/// channels 1, 3, or 4 (CMYK).
std::string make_jpeg(const Image& image, int channels, bool progressive);
std::string make_bmp(const Image& image);
/// channels 3 or 4 (alpha).
std::string make_tga(const Image& image, bool run_length);
/// The shared-exponent image of `image`, flat or run-length encoded (width at least 8).
std::string make_hdr(const Image& image, bool run_length);
std::string make_big_endian_pfm(const Image& image);

/// Compression by Imf::Compression; pixels half or float; data window starting at (x0, y0).
struct ExrLayout {
    int compression = 3;
    bool half = false;
    int x0 = 0, y0 = 0;
    bool tiled = false;
    int parts = 1;
    std::vector<std::string> channels{"R", "G",
                                      "B"};  ///< channel c holds channel c % image.channels
    std::vector<float> chromaticities = {};  ///< x and y of red, green, blue and white; or none
    int overscan = 0;  ///< pixels around the display window; negative: that many of it are missing
};
void make_exr(const std::filesystem::path& file, const Image& image, const ExrLayout& layout);

}  // namespace burnish::test_files
