// Images from and to files: which format, and the dispatch to its decoder.
#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "burnish/error.h"
#include "core/count_of.h"
#include "image/files.h"
#include "image/formats.h"
#include "image/image.h"
#include "image/numbers.h"

namespace burnish {

namespace formats {

void check_size(const std::string& name, const char* format, long long width, long long height,
                int channels) {
    if (width < 1 || height < 1)
        throw InputError(fmt::format("{}: {} file of {} x {} pixels, expected at least 1 x 1", name,
                                     format, width, height));
    if (width > kMaxImageSide || height > kMaxImageSide ||
        static_cast<std::size_t>(width * height) * static_cast<std::size_t>(channels) >
            kMaxImageValues)
        throw InputError(
            fmt::format("{}: {} file of {} x {} pixels with {}, expected at most {} pixels a "
                        "side and {} values",
                        name, format, width, height, count_of(channels, "channel"), kMaxImageSide,
                        kMaxImageValues));
}

void fail(const std::string& name, const char* format, const std::string& what) {
    throw InputError(fmt::format("{}: damaged {} file: {}", name, format, what));
}

void refuse(const std::string& name, const char* format, const std::string& what) {
    throw InputError(fmt::format("{}: this {} file is not supported: {}", name, format, what));
}

void refuse_unknown(const std::string& name, const char* format, const std::string& what) {
    refuse(name, format, "found what is damaged or not known (" + what + ")");
}

void take_alpha(ImageFile& file) {
    Image all = std::move(file.image);
    const int colors = all.channels - 1 + all.channels % 2;
    if (colors == all.channels) {
        file.image = std::move(all);
        return;
    }
    file.image = make_image(all.width, all.height, colors);
    file.alpha = make_image(all.width, all.height, 1);
    auto color = file.image.values.begin();
    auto alpha = file.alpha.values.begin();
    for (auto at = all.values.begin(); at != all.values.end(); at += all.channels) {
        color = std::copy(at, at + colors, color);
        *alpha++ = at[colors];
    }
}

}  // namespace formats

namespace {

enum class Format { kPng, kJpeg, kExr, kPfm, kHdr, kStb, kUnknown };

Format detect(std::string_view bytes) {
    const auto starts = [&](std::string_view magic) {
        return bytes.substr(0, magic.size()) == magic;
    };
    if (starts("\x89PNG\r\n\x1a\n")) return Format::kPng;
    if (starts("\xff\xd8\xff")) return Format::kJpeg;
    if (starts("\x76\x2f\x31\x01")) return Format::kExr;
    if ((starts("PF") || starts("Pf")) && bytes.find_first_of(" \t\r\n") == 2) return Format::kPfm;
    if (starts("#?")) return Format::kHdr;
    if (starts("BM")) return Format::kStb;
    return formats::looks_like_tga(bytes) ? Format::kStb : Format::kUnknown;
}

std::string first_bytes(std::string_view bytes) {
    std::string text;
    for (const char c : bytes.substr(0, 8))
        text += fmt::format("{:02x} ", static_cast<unsigned char>(c));
    if (!text.empty()) text.pop_back();
    return text;
}

void check_writable(const std::filesystem::path& file, const Image& image) {
    const std::size_t count = image.index(0, image.height);
    const bool has_alpha = image.channels == 2 || image.channels == 4;
    const bool takes_alpha = lower_extension(file) != ".pfm";
    if (image.width < 1 || image.height < 1 || image.channels < 1 || image.channels > 4 ||
        (has_alpha && !takes_alpha) || image.values.size() != count)
        throw InputError(fmt::format(
            "{}: cannot write an image of {} x {} pixels, {} channels and {} values, expected 1 or "
            "3 channels{}",
            file.string(), image.width, image.height, image.channels, image.values.size(),
            takes_alpha ? ", or 2 or 4 with alpha" : ""));
    if (!is_side(image.width) || !is_side(image.height) || count > kMaxImageValues)
        throw InputError(
            fmt::format("{}: cannot write an image of {} x {} pixels with {}, expected at most {} "
                        "pixels a side and {} values",
                        file.string(), image.width, image.height,
                        count_of(image.channels, "channel"), kMaxImageSide, kMaxImageValues));
}

/// A format of pictures that is not read, told by the first bytes; null: none that is known.
const char* known_format(std::string_view bytes) {
    const auto has = [&](std::size_t at, std::string_view text) {
        return bytes.size() >= at && bytes.substr(at).starts_with(text);
    };
    using namespace std::string_view_literals;
    if (has(4, "ftypavif")) return "AVIF";
    if (has(4, "ftyphei") || has(4, "ftyphev") || has(4, "ftypmif1")) return "HEIC";
    if (has(0, "II*\0"sv) || has(0, "MM\0*"sv)) return "TIFF or raw";
    if (has(0, "RIFF") && has(8, "WEBP")) return "WebP";
    const bool is_netpbm =
        bytes.size() > 2 && std::string_view(" \t\r\n#").find(bytes[2]) != std::string_view::npos;
    if (is_netpbm && has(0, "P5")) return "PGM";
    if (is_netpbm && has(0, "P6")) return "PPM";
    return nullptr;
}

ImageFile read_file(const std::filesystem::path& file, std::string_view bytes,
                    formats::FileColors colors, formats::Content content) {
    const std::string name = file.string();
    switch (detect(bytes)) {
        case Format::kPng:
            return formats::decode_png(name, bytes, content);
        case Format::kJpeg:
            return formats::decode_jpeg(name, bytes, content);
        case Format::kExr:
            return formats::read_exr(file, colors, content);
        case Format::kPfm:
            return formats::decode_pfm(name, bytes, content);
        case Format::kHdr:
            return formats::decode_hdr(name, bytes, colors, content);
        case Format::kStb:
            return formats::decode_stb(name, bytes, content);
        case Format::kUnknown:
            break;
    }
    const char* known = known_format(bytes);
    const std::string found =
        known ? fmt::format("a {} file, which is not read", known)
              : fmt::format("not an image that can be read ({} bytes that start with [{}])",
                            bytes.size(), first_bytes(bytes));
    throw InputError(
        fmt::format("{}: {}, expected PNG, JPEG, EXR, HDR, PFM, BMP or TGA", name, found));
}

}  // namespace

ImageFile read_image_file(const std::filesystem::path& file) {
    return read_file(file, read_bytes(file), formats::FileColors::kRec709, formats::Content::kAll);
}

ImageFile read_image_header(const std::filesystem::path& file) {
    // Where decoders ask whether a file is long enough for its size, that is enough for nearly all.
    constexpr std::size_t kStart = std::size_t{1} << 20;
    const auto read = [&](std::size_t max) {
        return read_file(file, read_start(file, max), formats::FileColors::kRec709,
                         formats::Content::kHeader);
    };
    try {
        return read(kStart);
    } catch (const InputError&) {  // what comes before the header's end may be longer
        return read(kWholeFile);
    }
}

ImageFile read_numbers_file(const std::filesystem::path& file) {
    return read_file(file, read_bytes(file), formats::FileColors::kAsStored,
                     formats::Content::kAll);
}

void require_no_overscan(const ImageFile& read, const std::string& file) {
    if (read.overscan)
        throw InputError(file +
                         ": the EXR's data window is not its display window: expected a whole "
                         "picture without overscan");
}

Image read_image(const std::string& file) {
    ImageFile read = read_image_file(file);
    if (read.encoding != PixelEncoding::kFloat)
        for (float& value : read.image.values) value = srgb_to_linear(value);
    return oriented(std::move(read.image), read.orientation);
}

void write_image(const std::string& file, const Image& image) { write_image(file, image, true); }

void write_image(const std::filesystem::path& file, const Image& image, bool srgb) {
    check_writable(file, image);
    const std::string extension = lower_extension(file);
    if (extension == ".exr")
        write_bytes(file, formats::encode_exr(image));
    else if (extension == ".pfm")
        write_bytes(file, formats::encode_pfm(image));
    else if (extension == ".png")
        write_bytes(file, encode_png(image, srgb));
    else
        throw InputError(
            fmt::format("{}: cannot write the format \"{}\", expected .exr, .pfm or .png",
                        file.string(), extension));
}

}  // namespace burnish
