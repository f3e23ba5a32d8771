// One decoder per format family, private to image/. `name` is the file's name for messages; every
// decoder throws InputError for truncated, damaged or oversized data, and checks sizes before it
// allocates. To add a format: a file with its decoder, its declaration here, its magic in
// image_files.cpp.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "image/image.h"

namespace burnish::formats {

/// Throws InputError where a side is not in [1, kMaxImageSide] or the image has more than
/// kMaxImageValues values.
void check_size(const std::string& name, const char* format, long long width, long long height,
                int channels);

/// "NAME: damaged FORMAT file: WHAT" as InputError.
[[noreturn]] void fail(const std::string& name, const char* format, const std::string& what);
/// "NAME: this FORMAT file is not supported: WHAT" as InputError: of a file that may be sound.
[[noreturn]] void refuse(const std::string& name, const char* format, const std::string& what);
/// The same where a library does not say which of the two it is.
[[noreturn]] void refuse_unknown(const std::string& name, const char* format,
                                 const std::string& what);

/// Of an image of two or four channels, the last of which is alpha: takes that one out of it.
void take_alpha(ImageFile& file);

/// What is decoded of a file; see read_image_header.
enum class Content { kHeader, kAll };
/// What becomes of X, Y, Z and of chromaticities.
enum class FileColors { kRec709, kAsStored };

ImageFile decode_png(const std::string& name, std::string_view bytes, Content content);
ImageFile decode_jpeg(const std::string& name, std::string_view bytes, Content content);
/// What a JPEG's APP1 segment says.
struct Exif {
    int orientation = 0;           ///< 1 to 8; 0: nothing
    bool is_uncalibrated = false;  ///< its colours are not those of sRGB: mostly of Adobe RGB
};
/// Of any bytes.
Exif read_exif(std::string_view segment);
/// The name of an ICC profile in ASCII, as "Display P3"; empty: it has none. Any bytes.
std::string profile_name(std::string_view icc);
ImageFile decode_pfm(const std::string& name, std::string_view bytes, Content content);
ImageFile decode_hdr(const std::string& name, std::string_view bytes, FileColors colors,
                     Content content);
/// A BMP file as stb_image reads it rightly: a header of 40, 108 or 124 bytes, a colour for each
/// index, black where the file has none, and the pixels at once behind them.
std::string plain_bmp(const std::string& name, std::string_view bytes);
/// Whether such a file has a palette, and no colour in it but greys.
bool has_gray_palette(std::string_view plain);
/// BMP and TGA.
ImageFile decode_stb(const std::string& name, std::string_view bytes, Content content);
/// Whether the bytes look like a TGA file, which has no magic number.
bool looks_like_tga(std::string_view bytes);
/// Throws InputError where the header of an OpenEXR file claims more bytes than the file has, and
/// where its first part is deep.
void require_exr_header(const std::filesystem::path& file);
/// Scanline or tiled, any compression, first part. Channels R, G, B, or X, Y, Z, or Y, of one
/// layer, or the only one.
ImageFile read_exr(const std::filesystem::path& file, FileColors colors, Content content);

/// 32-bit float, ZIP; channels Y or R, G, B, and A of an image of two or four.
std::string encode_exr(const Image& image);
/// Of one channel or three.
std::string encode_pfm(const Image& image);

}  // namespace burnish::formats
