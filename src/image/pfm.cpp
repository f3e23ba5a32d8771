// Portable float maps: "PF" (RGB) or "Pf" (gray), width, height, scale, then rows from bottom to
// top. A negative scale means little-endian; its magnitude multiplies the values.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include "core/bytes.h"
#include "core/parsed.h"
#include "image/formats.h"

namespace burnish {

namespace {

/// The next word of the header, empty at its end; consumes the one blank after it.
std::string_view next_word(std::string_view bytes, std::size_t& offset) {
    const auto blank = [&](std::size_t i) {
        return i >= bytes.size() || std::strchr(" \t\r\n", bytes[i]) != nullptr;
    };
    while (offset < bytes.size() && blank(offset)) ++offset;
    const std::size_t begin = offset;
    while (!blank(offset)) ++offset;
    const std::string_view word = bytes.substr(begin, offset - begin);
    offset = std::min(offset + 1, bytes.size());
    return word;
}

template <class T>
T number(const std::string& name, std::string_view bytes, std::size_t& offset, const char* what) {
    const std::string_view word = next_word(bytes, offset);
    const std::optional<T> value = parsed<T>(without_plus(word));
    if (!value)
        formats::fail(name, "PFM",
                      fmt::format("byte offset {}: found \"{:.40}\", expected the {}",
                                  word.data() - bytes.data(), word, what));
    return *value;
}

float float_at(std::string_view bytes, std::size_t at, std::endian order) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(number_at(bytes, at, 4, order)));
}

}  // namespace

ImageFile formats::decode_pfm(const std::string& name, std::string_view bytes, Content content) {
    std::size_t offset = 0;
    const int channels = next_word(bytes, offset) == "PF" ? 3 : 1;
    const int width = number<int>(name, bytes, offset, "width");
    const int height = number<int>(name, bytes, offset, "height");
    const float scale = number<float>(name, bytes, offset, "scale");
    check_size(name, "PFM", width, height, channels);
    if (!std::isfinite(scale) || scale == 0)
        fail(name, "PFM",
             fmt::format("found the scale {}, expected a finite number other than 0", scale));
    if (content == Content::kHeader)
        return {Image{width, height, channels}, PixelEncoding::kFloat, "PFM"};
    const std::size_t row = static_cast<std::size_t>(width) * static_cast<std::size_t>(channels);
    const std::size_t expected = row * static_cast<std::size_t>(height) * 4;
    // The scale's line may end in CR LF; behind a CR alone, LF is the first byte of a number.
    const bool has_cr_lf = bytes.substr(2, 2) == "\r\n" || bytes.size() - offset > expected;
    if (has_cr_lf && bytes.substr(offset - 1, 2) == "\r\n") ++offset;
    if (bytes.size() - offset < expected)
        fail(name, "PFM",
             "byte offset " + std::to_string(bytes.size()) +
                 ": the file ends too early, expected " + std::to_string(offset + expected) +
                 " bytes");
    const std::endian order = scale < 0 ? std::endian::little : std::endian::big;
    ImageFile file{make_image(width, height, channels), PixelEncoding::kFloat, "PFM"};
    for (int y = 0; y < height; ++y)
        for (std::size_t i = 0; i < row; ++i) {
            const std::size_t source = static_cast<std::size_t>(height - 1 - y) * row + i;
            file.image.values[file.image.index(0, y) + i] =
                float_at(bytes, offset + 4 * source, order) * std::abs(scale);
        }
    return file;
}

std::string formats::encode_pfm(const Image& image) {
    std::string bytes = (image.channels == 3 ? "PF\n" : "Pf\n") + std::to_string(image.width) +
                        " " + std::to_string(image.height) + "\n-1.0\n";
    const std::size_t row = image.index(0, 1);
    for (int y = image.height - 1; y >= 0; --y)
        for (std::size_t i = 0; i < row; ++i) {
            const auto bits = std::bit_cast<std::uint32_t>(image.values[image.index(0, y) + i]);
            for (int shift = 0; shift < 32; shift += 8)
                bytes += static_cast<char>((bits >> shift) & 0xff);
        }
    return bytes;
}

}  // namespace burnish
