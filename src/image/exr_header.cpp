// What the header of an OpenEXR file claims, before the library sees it: OpenEXR 3.1 makes room for
// an attribute, and for the place of each chunk, as the header says, also where the file is short.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

#include "core/bytes.h"
#include "image/formats.h"

namespace burnish {

namespace {

constexpr std::uint64_t kMaxName = 255;  ///< characters
constexpr std::uint64_t kPlace = 8;      ///< bytes of the place of a chunk

/// What says how many chunks a part has.
struct Chunks {
    std::uint64_t width = 0, height = 0;            ///< of the data window
    std::uint64_t tile_width = 0, tile_height = 0;  ///< 0: rows
    std::uint64_t count = 0;                        ///< as the header says it; 0: it does not
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

void note(const std::string& attribute, std::string_view value, Chunks& chunks) {
    const auto word = [&](std::size_t i) { return number_at(value, 4 * i, 4); };
    if (attribute == "dataWindow")
        chunks.width = side(word(0), word(2)), chunks.height = side(word(1), word(3));
    if (attribute == "tiles") chunks.tile_width = word(0), chunks.tile_height = word(1);
    if (attribute == "chunkCount") chunks.count = word(0);
}

std::uint64_t min_chunks(const Chunks& c) {
    if (c.tile_width == 0 || c.tile_height == 0) return c.count;
    if (std::max(c.width, c.height) > kMaxImageSide) return c.count;  // refused by the library
    const auto tiles = [](std::uint64_t pixels, std::uint64_t side) {
        return (pixels + side - 1) / side;
    };
    return std::max(c.count, tiles(c.width, c.tile_width) * tiles(c.height, c.tile_height));
}

/// Returns whether the header has any attribute: behind the last one of a file of parts stands one
/// that has none. What is no attribute, the library refuses.
bool require_header(const std::string& name, std::uint64_t size, std::istream& stream) {
    constexpr std::uint64_t kMaxOfValue = 16;
    Chunks chunks;
    std::string attribute, type;
    bool has_any = false;
    while (read_name(stream, attribute) && !attribute.empty() && read_name(stream, type)) {
        has_any = true;
        std::array<char, kMaxOfValue> bytes{};
        if (!stream.read(bytes.data(), 4)) return false;
        const std::uint64_t length = number_at({bytes.data(), 4}, 0, 4);
        const auto at = static_cast<std::uint64_t>(stream.tellg());
        if (length > size - at)
            formats::fail(name, "EXR",
                          fmt::format("byte offset {}: found an attribute of {} bytes, expected at "
                                      "most {}: the file ends there",
                                      at - 4, length, size - at));
        const std::uint64_t read = std::min(length, kMaxOfValue);
        stream.read(bytes.data(), static_cast<std::streamsize>(read));
        note(attribute, {bytes.data(), read}, chunks);
        stream.seekg(static_cast<std::streamoff>(at + length));
    }
    if (min_chunks(chunks) > size / kPlace)
        formats::fail(name, "EXR",
                      fmt::format("found {} chunks in its header, expected at most {}, a place of "
                                  "{} bytes for each",
                                  min_chunks(chunks), size / kPlace, kPlace));
    return has_any;
}

}  // namespace

void formats::require_exr_header(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::array<char, 8> start{};  // a magic number and the version with its flags
    if (!stream.read(start.data(), start.size())) return;
    const bool has_parts = (number_at({start.data(), start.size()}, 4, 4) & 0x1000) != 0;
    const std::uint64_t size = std::filesystem::file_size(file);
    while (require_header(file.string(), size, stream) && has_parts) {
    }
}

}  // namespace burnish
