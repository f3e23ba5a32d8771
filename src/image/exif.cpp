// The orientation of an EXIF segment: a TIFF file whose first directory has tag 0x0112, one SHORT
// from 1 to 8. Nothing else of it is read.
#include <cstdint>

#include "image/formats.h"

namespace burnish {

namespace {

constexpr std::string_view kMagic{"Exif\0\0", 6};
constexpr std::uint32_t kOrientation = 0x0112, kShort = 3;

struct Tiff {
    std::string_view bytes;
    bool little_endian = false;

    /// An unsigned number of so many bytes; 0 beyond the end.
    std::uint32_t number(std::size_t at, std::size_t size) const {
        if (at > bytes.size() || size > bytes.size() - at) return 0;
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < size; ++i) {
            const std::size_t k = little_endian ? size - 1 - i : i;
            value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
        }
        return value;
    }
};

}  // namespace

int formats::exif_orientation(std::string_view segment) {
    if (!segment.starts_with(kMagic)) return 0;
    Tiff tiff{segment.substr(kMagic.size())};
    tiff.little_endian = tiff.bytes.starts_with("II");
    if (!tiff.little_endian && !tiff.bytes.starts_with("MM")) return 0;
    if (tiff.number(2, 2) != 42) return 0;
    constexpr std::size_t kEntry = 12;
    const std::size_t directory = tiff.number(4, 4);
    const std::uint32_t count = tiff.number(directory, 2);
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::size_t entry = directory + 2 + kEntry * i;
        if (tiff.number(entry, 2) != kOrientation) continue;
        const std::uint32_t value = tiff.number(entry + 8, 2);
        const bool is_one_short =
            tiff.number(entry + 2, 2) == kShort && tiff.number(entry + 4, 4) == 1;
        return is_one_short && value >= 1 && value <= 8 ? static_cast<int>(value) : 0;
    }
    return 0;
}

}  // namespace burnish
