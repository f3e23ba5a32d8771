// An EXIF segment: a TIFF file. Its first directory has the orientation, tag 0x0112, one SHORT from
// 1 to 8, and where EXIF's own directory stands, tag 0x8769, one LONG; that one has the colour
// space, tag 0xA001, one SHORT. Nothing else of it is read.
#include <bit>
#include <cstdint>
#include <optional>

#include "core/bytes.h"
#include "image/formats.h"

namespace burnish {

namespace {

constexpr std::string_view kMagic{"Exif\0\0", 6};
constexpr std::uint64_t kShort = 3, kLong = 4;

struct Tiff {
    std::string_view bytes;
    std::endian order = std::endian::little;

    std::uint64_t number(std::size_t at, std::size_t size) const {
        return number_at(bytes, at, size, order);
    }
};

/// The value of a tag that has one of that type; none: the directory has no such tag.
std::optional<std::uint64_t> find(const Tiff& tiff, std::size_t directory, std::uint64_t tag,
                                  std::uint64_t type) {
    constexpr std::size_t kEntry = 12;
    const std::uint64_t count = tiff.number(directory, 2);
    std::size_t entry = directory + 2;
    for (std::uint64_t i = 0; i < count && entry < tiff.bytes.size(); ++i, entry += kEntry) {
        if (tiff.number(entry, 2) != tag) continue;
        if (tiff.number(entry + 2, 2) != type || tiff.number(entry + 4, 4) != 1) return {};
        return tiff.number(entry + 8, type == kShort ? 2 : 4);
    }
    return {};
}

}  // namespace

formats::Exif formats::read_exif(std::string_view segment) {
    Exif exif;
    if (!segment.starts_with(kMagic)) return exif;
    Tiff tiff{segment.substr(kMagic.size())};
    if (tiff.bytes.starts_with("MM"))
        tiff.order = std::endian::big;
    else if (!tiff.bytes.starts_with("II"))
        return exif;
    if (tiff.number(2, 2) != 42) return exif;
    const std::size_t first = tiff.number(4, 4);
    const std::uint64_t orientation = find(tiff, first, 0x0112, kShort).value_or(0);
    if (orientation <= 8) exif.orientation = static_cast<int>(orientation);
    constexpr std::uint64_t kUncalibrated = 0xffff;
    if (const auto own = find(tiff, first, 0x8769, kLong))
        exif.is_uncalibrated = find(tiff, *own, 0xa001, kShort) == kUncalibrated;
    return exif;
}

}  // namespace burnish
