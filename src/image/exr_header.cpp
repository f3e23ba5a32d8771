// What the header of an OpenEXR file claims, before the library sees it: OpenEXR 3.1 makes room for
// an attribute, and for the place of each chunk, as the header says, also where the file is short,
// and for as many samples of a deep image as the file claims.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "core/bytes.h"
#include "image/formats.h"

namespace burnish {

namespace {

constexpr std::uint64_t kMaxName = 255;  ///< characters
constexpr std::uint64_t kPlace = 8;      ///< bytes of the place of a chunk

/// What the header of a part says of it.
struct Part {
    std::uint64_t width = 0, height = 0;            ///< of the data window
    std::uint64_t tile_width = 0, tile_height = 0;  ///< 0: rows
    std::uint64_t chunks = 0;                       ///< as the header says it; 0: it does not
    bool is_deep = false;                           ///< pixels have any number of samples
};

/// Up to the 0 behind it. Returns whether there is one.
bool read_name(std::istream& stream, std::string& name) {
    std::array<char, kMaxName + 1> text;
    stream.getline(text.data(), text.size(), '\0');
    name = text.data();
    return !stream.fail() && !stream.eof();
}

std::uint64_t side(std::uint64_t first, std::uint64_t last) {
    const auto begin = static_cast<std::int32_t>(first), end = static_cast<std::int32_t>(last);
    return begin <= end ? static_cast<std::uint64_t>(std::int64_t{end} - begin + 1) : 0;
}

void note(const std::string& attribute, std::string_view value, Part& part) {
    const auto word = [&](std::size_t i) { return number_at(value, 4 * i, 4); };
    if (attribute == "dataWindow")
        part.width = side(word(0), word(2)), part.height = side(word(1), word(3));
    if (attribute == "tiles") part.tile_width = word(0), part.tile_height = word(1);
    if (attribute == "chunkCount") part.chunks = word(0);
    if (attribute == "type") part.is_deep = value == "deepscanline" || value == "deeptile";
}

std::uint64_t min_chunks(const Part& part) {
    if (part.tile_width == 0 || part.tile_height == 0) return part.chunks;
    if (std::max(part.width, part.height) > kMaxImageSide)
        return part.chunks;  // refused by the library
    const auto tiles = [](std::uint64_t pixels, std::uint64_t side) {
        return (pixels + side - 1) / side;
    };
    return std::max(part.chunks,
                    tiles(part.width, part.tile_width) * tiles(part.height, part.tile_height));
}

/// Nothing where the header has no attribute: such a one stands behind the last one of a file of
/// parts. What is no attribute, the library refuses.
std::optional<Part> read_part(const std::string& name, std::uint64_t size, std::istream& stream) {
    constexpr std::uint64_t kMaxOfValue = 16;
    Part part;
    std::string attribute, type;
    bool has_any = false;
    while (read_name(stream, attribute) && !attribute.empty() && read_name(stream, type)) {
        has_any = true;
        std::array<char, kMaxOfValue> bytes{};
        if (!stream.read(bytes.data(), 4)) return {};
        const std::uint64_t length = number_at({bytes.data(), 4}, 0, 4);
        const auto at = static_cast<std::uint64_t>(stream.tellg());
        if (length > size - at)
            formats::fail(name, "EXR",
                          fmt::format("byte offset {}: found an attribute of {} bytes, expected at "
                                      "most {}: the file ends there",
                                      at - 4, length, size - at));
        const std::uint64_t read = std::min(length, kMaxOfValue);
        stream.read(bytes.data(), static_cast<std::streamsize>(read));
        note(attribute, {bytes.data(), read}, part);
        stream.seekg(static_cast<std::streamoff>(at + length));
    }
    if (min_chunks(part) > size / kPlace)
        formats::fail(name, "EXR",
                      fmt::format("found {} chunks in its header, expected at most {}, a place of "
                                  "{} bytes for each",
                                  min_chunks(part), size / kPlace, kPlace));
    return has_any ? std::optional(part) : std::nullopt;
}

}  // namespace

void formats::require_exr_header(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::array<char, 8> start{};  // a magic number and the version with its flags
    if (!stream.read(start.data(), start.size())) return;
    const bool has_parts = (number_at({start.data(), start.size()}, 4, 4) & 0x1000) != 0;
    const std::uint64_t size = std::filesystem::file_size(file);
    std::optional<Part> part = read_part(file.string(), size, stream);
    if (part && part->is_deep)
        refuse(file.string(), "EXR",
               "found a deep image, expected one sample of each channel in a pixel");
    while (part && has_parts) part = read_part(file.string(), size, stream);
}

}  // namespace burnish
