// BMP files that stb_image misreads or does not know, as ones that it reads: headers of 12 (OS/2),
// 52 and 56 bytes, palettes that have fewer colours than there are indices, and bytes between the
// header and the pixels. Numbers are little-endian.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>

#include "core/bytes.h"
#include "image/formats.h"

namespace burnish {

namespace {

std::string four_bytes(std::size_t number) {
    std::string bytes;
    for (int i = 0; i < 4; ++i) bytes += static_cast<char>((number >> (8 * i)) & 255);
    return bytes;
}

constexpr std::size_t kFileHeader = 14;
constexpr std::size_t kNone = 0, kBitFields = 3;  // compressions

/// Both headers, one behind the other, and the masks behind that of 40 bytes.
std::string plain_headers(std::string_view bytes, std::size_t header, std::size_t masks) {
    std::string plain(bytes.substr(0, kFileHeader));
    if (header == 12) {  // the size in numbers of two bytes; planes and bits; no compression
        plain += four_bytes(40) + four_bytes(number_at(bytes, 18, 2)) +
                 four_bytes(number_at(bytes, 20, 2)) + std::string(bytes.substr(22, 4));
        plain.resize(kFileHeader + 40);
    } else if (header == 52 || header == 56) {  // the first part of one of 108
        plain += four_bytes(108) + std::string(bytes.substr(18, header - 4));
        plain.resize(kFileHeader + 108);
    } else {
        plain += bytes.substr(kFileHeader, header + masks);
    }
    return plain;
}

/// 2^bits colours of four bytes, from colours of three or four.
std::string whole_palette(std::string_view colors, std::size_t size, std::size_t bits) {
    std::string palette;
    for (std::size_t i = 0; i < std::size_t{1} << bits; ++i) {
        const bool is_there = (i + 1) * size <= colors.size();
        palette += four_bytes(is_there ? number_at(colors, i * size, 3) : 0);
    }
    return palette;
}

}  // namespace

std::string formats::plain_bmp(const std::string& name, std::string_view bytes) {
    constexpr std::size_t kShortest = kFileHeader + 12;
    const std::size_t pixels = number_at(bytes, 10, 4), header = number_at(bytes, kFileHeader, 4);
    if (bytes.size() < kShortest || bytes.size() < pixels)
        fail(name, "BMP", "the file ends too early");
    constexpr std::size_t kHeaders[] = {12, 40, 52, 56, 108, 124};
    if (std::ranges::find(kHeaders, header) == std::end(kHeaders))
        refuse(
            name, "BMP",
            fmt::format("found a header of {} bytes, expected 12, 40, 52, 56, 108 or 124", header));
    const bool is_os2 = header == 12;
    const std::size_t bits = number_at(bytes, is_os2 ? 24 : 28, 2);
    const std::size_t compression = is_os2 ? 0 : number_at(bytes, 30, 4);
    if (compression != kNone && compression != kBitFields)
        refuse(name, "BMP",
               fmt::format("found the compression {}, expected none or bit fields, {} or {}",
                           compression, kNone, kBitFields));
    const std::size_t masks = header == 40 && compression == kBitFields ? 12 : 0;
    const std::size_t end = kFileHeader + header + masks;
    if (pixels < end)
        fail(name, "BMP",
             fmt::format("found the pixels at byte {}, expected {} or more", pixels, end));
    std::string plain = plain_headers(bytes, header, masks);
    if (bits <= 8) plain += whole_palette(bytes.substr(end, pixels - end), is_os2 ? 3 : 4, bits);
    plain.replace(10, 4, four_bytes(plain.size()));
    plain += bytes.substr(pixels);
    return plain;
}

bool formats::has_gray_palette(std::string_view plain) {
    const std::size_t pixels = number_at(plain, 10, 4), bits = number_at(plain, 28, 2);
    if (bits > 8) return false;
    for (std::size_t at = pixels - (std::size_t{4} << bits); at < pixels; at += 4)
        if (plain[at] != plain[at + 1] || plain[at] != plain[at + 2]) return false;
    return true;
}

}  // namespace burnish
