// PNG by libpng. Its errors leave by longjmp, so every function between setjmp and libpng holds
// plain data only.
#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstdint>
#include <cstring>

#include "burnish/error.h"
#include "core/parallel.h"
#include "image/formats.h"

namespace burnish {

namespace {

struct PngSource {
    const char* next = nullptr;
    std::size_t left = 0;
    char message[160] = {};
};

struct PngReader {
    png_structp png = nullptr;
    png_infop info = nullptr;
    PngReader() = default;
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;
    ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

struct PngHeader {
    png_uint_32 width = 0, height = 0;
    int channels = 0, bits = 0;  ///< as decoded: with alpha, 8 or 16
    int stored_bits = 0;
    std::size_t row_bytes = 0;
    std::size_t stored_row_bytes = 0;
};

void on_error(png_structp png, png_const_charp message) {
    auto* source = static_cast<PngSource*>(png_get_error_ptr(png));
    std::strncpy(source->message, message, sizeof source->message - 1);
    std::longjmp(png_jmpbuf(png), 1);
}
void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep out, std::size_t count) {
    auto* source = static_cast<PngSource*>(png_get_io_ptr(png));
    if (source->left < count) png_error(png, "the file ends too early");
    std::memcpy(out, source->next, count);
    source->next += count, source->left -= count;
}

/// What libpng would inflate, each up to 8 MB, and nobody asks for: texts, palettes that are
/// suggested.
void skip_what_is_not_read(png_structp png) {
    constexpr png_byte kNames[] = "tEXt\0zTXt\0iTXt\0sPLT";  // five bytes each
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, kNames, 4);
}

/// Asks for 8 or 16 bits of gray or RGB, with alpha where there is one. False where libpng failed.
bool read_header(const PngReader& reader, PngHeader& header) {
    png_structp png = reader.png;
    if (setjmp(png_jmpbuf(png))) return false;
    png_set_user_limits(png, kMaxImageSide, kMaxImageSide);
    skip_what_is_not_read(png);
    png_read_info(png, reader.info);
    header.stored_row_bytes = png_get_rowbytes(png, reader.info);
    const int type = png_get_color_type(png, reader.info);
    if (type == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
    if (type == PNG_COLOR_TYPE_GRAY) png_set_expand_gray_1_2_4_to_8(png);
    if (png_get_valid(png, reader.info, PNG_INFO_tRNS)) png_set_tRNS_to_alpha(png);
    header.stored_bits = png_get_bit_depth(png, reader.info);
    png_set_interlace_handling(png);
    png_read_update_info(png, reader.info);
    header.width = png_get_image_width(png, reader.info);
    header.height = png_get_image_height(png, reader.info);
    header.channels = png_get_channels(png, reader.info);
    header.bits = png_get_bit_depth(png, reader.info);
    header.row_bytes = png_get_rowbytes(png, reader.info);
    return true;
}

/// What libpng holds as the file's profile; empty: it has none.
std::string_view profile_of(const PngReader& reader) {
    png_charp name = nullptr;
    png_bytep profile = nullptr;
    png_uint_32 size = 0;
    int compression = 0;
    png_get_iCCP(reader.png, reader.info, &name, &compression, &profile, &size);
    return {reinterpret_cast<const char*>(profile), size};
}

/// Whether the file's gamma is that of linear numbers. A profile, or the word that they are sRGB,
/// counts before it.
bool says_linear(const PngReader& reader) {
    constexpr double kTolerance = 0.05;
    double exponent = 0;  // of the encoding
    if (png_get_valid(reader.png, reader.info, PNG_INFO_sRGB | PNG_INFO_iCCP) != 0) return false;
    return png_get_gAMA(reader.png, reader.info, &exponent) != 0 &&
           std::abs(exponent - 1) <= kTolerance;
}

/// In the place of a profile's name.
constexpr const char* kOtherPrimaries = "other primaries by cHRM";

/// Whether the file has primaries, and others than those of sRGB. A profile, or the word that they
/// are sRGB, counts before them.
bool has_other_primaries(const PngReader& reader) {
    constexpr std::array<double, 8> kSrgb{0.3127, 0.329, 0.64, 0.33, 0.3, 0.6, 0.15, 0.06};
    constexpr double kTolerance = 0.01;
    std::array<double, 8> xy{};  // of white, red, green and blue
    if (png_get_valid(reader.png, reader.info, PNG_INFO_sRGB | PNG_INFO_iCCP) != 0) return false;
    if (!png_get_cHRM(reader.png, reader.info, &xy[0], &xy[1], &xy[2], &xy[3], &xy[4], &xy[5],
                      &xy[6], &xy[7]))
        return false;
    return !std::ranges::equal(xy, kSrgb, [](double found, double expected) {
        return std::abs(found - expected) <= kTolerance;
    });
}

bool read_rows(const PngReader& reader, png_bytepp rows) {
    if (setjmp(png_jmpbuf(reader.png))) return false;
    png_read_image(reader.png, rows);
    png_read_end(reader.png, nullptr);
    return true;
}

std::vector<float> to_floats(const std::vector<std::uint8_t>& data, int bits) {
    if (bits == 8) {
        std::vector<float> values(data.size());
        std::transform(data.begin(), data.end(), values.begin(),
                       [](std::uint8_t v) { return float(v) / 255.0f; });
        return values;
    }
    std::vector<float> values(data.size() / 2);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<float>(data[2 * i] * 256 + data[2 * i + 1]) / 65535.0f;
    return values;
}

/// Before anything is allocated for the pixels that a header claims.
void require_bytes(const std::string& name, const PngHeader& header, std::size_t found) {
    constexpr std::size_t kMaxRatio = 1032;  // of deflate
    const std::size_t min = header.stored_row_bytes * header.height / kMaxRatio;
    if (min > found)
        formats::fail(name, "PNG",
                      fmt::format("found {} bytes, expected {} or more for {} x {} pixels", found,
                                  min, header.width, header.height));
}

}  // namespace

ImageFile formats::decode_png(const std::string& name, std::string_view bytes, Content content) {
    PngSource source{bytes.data(), bytes.size(), {}};
    PngReader reader;
    reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, on_error, on_warning);
    reader.info = reader.png ? png_create_info_struct(reader.png) : nullptr;
    if (!reader.info) throw std::bad_alloc();
    png_set_read_fn(reader.png, &source, on_read);

    PngHeader header;
    if (!read_header(reader, header)) fail(name, "PNG", source.message);
    check_size(name, "PNG", header.width, header.height, header.channels);
    require_bytes(name, header, bytes.size());
    ImageFile file{
        {static_cast<int>(header.width), static_cast<int>(header.height), header.channels, {}},
        header.bits == 8 ? PixelEncoding::kUnorm8 : PixelEncoding::kUnorm16,
        "PNG",
        header.stored_bits};
    if (content == Content::kHeader) return file;
    std::vector<std::uint8_t> data(header.row_bytes * header.height);
    std::vector<png_bytep> rows(header.height);
    for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = data.data() + y * header.row_bytes;
    if (!read_rows(reader, rows.data())) fail(name, "PNG", source.message);
    file.image.values = to_floats(data, header.bits);
    file.profile = profile_name(profile_of(reader));
    file.says_linear = says_linear(reader);
    // Of one channel they say nothing; the larger error of linear numbers comes first.
    if (file.profile.empty() && !file.says_linear && header.channels >= 3 &&
        has_other_primaries(reader))
        file.profile = kOtherPrimaries;
    take_alpha(file);
    return file;
}

std::string encode_png(const Image& image, bool srgb) {
    const auto channels = static_cast<std::size_t>(image.channels);
    const bool has_alpha = channels % 2 == 0;
    CodedImage coded{image.width, image.height, image.channels, srgb,
                     std::vector<std::uint8_t>(image.values.size())};
    constexpr std::size_t kChunk = std::size_t{1} << 16;
    parallel_chunks(coded.codes.size(), kChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const bool is_alpha = has_alpha && i % channels == channels - 1;
            float v = image.values[i];
            if (has_alpha && !is_alpha) {  // PNG's colours are not multiplied with alpha
                const float alpha = image.values[i / channels * channels + channels - 1];
                v = alpha > 0 ? v / alpha : 0;
            }
            coded.codes[i] = code_of(v, srgb && !is_alpha);
        }
    });
    return encode_png(coded);
}

std::string encode_png(const CodedImage& image) {
    const auto channels = static_cast<std::size_t>(image.channels);
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = static_cast<png_uint_32>(image.width);
    png.height = static_cast<png_uint_32>(image.height);
    constexpr std::array<png_uint_32, 5> kFormats{0, PNG_FORMAT_GRAY, PNG_FORMAT_GA, PNG_FORMAT_RGB,
                                                  PNG_FORMAT_RGBA};
    png.format = channels < kFormats.size() ? kFormats[channels] : 0;
    // Compresses four times as fast to a tenth more bytes.
    png.flags = (image.srgb ? 0 : PNG_IMAGE_FLAG_COLORSPACE_NOT_sRGB) | PNG_IMAGE_FLAG_FAST;
    if (channels < 1 || channels > 4 || image.codes.empty())
        throw InputError(fmt::format(
            "an image of {} x {} pixels and {} channels cannot be written as PNG: expected one "
            "pixel or more, and 1 to 4 channels",
            image.width, image.height, image.channels));
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
    std::string bytes(size, '\0');
    if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, image.codes.data(), 0, nullptr))
        throw InputError(std::string("the image cannot be written as PNG: ") + png.message);
    bytes.resize(size);
    return bytes;
}

}  // namespace burnish
