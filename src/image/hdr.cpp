// Radiance HDR: text lines, then rows of pixels with a shared exponent, flat or run-length encoded
// by component. Read here and not by stb_image, which never returns from some files that are cut
// off.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstdio>

#include "image/formats.h"
#include "image/xyz.h"

namespace burnish {

namespace {

struct HdrReader {
    const std::string& name;
    std::string_view bytes;
    std::size_t offset = 0;
    std::size_t begin = 0;  ///< of the line, the row or the run that is read
    bool is_xyz = false;

    [[noreturn]] void fail(const std::string& what) const {
        formats::fail(name, "HDR", fmt::format("byte offset {}: {}", begin, what));
    }
    [[noreturn]] void refuse(const std::string& what) const {
        formats::refuse(name, "HDR", fmt::format("byte offset {}: {}", begin, what));
    }
    [[noreturn]] void fail_at_end() const {
        formats::fail(name, "HDR",
                      fmt::format("byte offset {}: the file ends too early", bytes.size()));
    }
};

/// Without its end, LF or CR LF.
std::string_view next_line(HdrReader& reader) {
    const std::size_t end = reader.bytes.find('\n', reader.offset);
    reader.begin = reader.offset;
    if (end == std::string_view::npos) reader.fail("the header ends too early");
    std::string_view line = reader.bytes.substr(reader.offset, end - reader.offset);
    if (line.ends_with('\r')) line.remove_suffix(1);
    reader.offset = end + 1;
    return line;
}

int next_byte(HdrReader& reader) {
    if (reader.offset >= reader.bytes.size()) reader.fail_at_end();
    return static_cast<unsigned char>(reader.bytes[reader.offset++]);
}

void read_variable(HdrReader& reader, std::string_view line) {
    if (!line.starts_with("FORMAT=")) return;
    const std::string_view format = line.substr(7, 15);
    reader.is_xyz = format == "32-bit_rle_xyze";
    if (format != "32-bit_rle_rgbe" && !reader.is_xyz)
        reader.refuse(fmt::format(
            "found \"{:.40}\", expected FORMAT=32-bit_rle_rgbe or FORMAT=32-bit_rle_xyze", line));
}

/// Reads the variables; returns the size from the line "-Y height +X width".
Image read_header(HdrReader& reader) {
    for (std::string_view line = next_line(reader); !line.empty(); line = next_line(reader))
        read_variable(reader, line);
    const std::string line(next_line(reader).substr(0, 80));
    if (line.starts_with("+Y ") || line.starts_with("+X ") || line.starts_with("-X ") ||
        line.find(" -X ") != std::string::npos)
        reader.refuse(fmt::format("found \"{:.40}\", expected \"-Y height +X width\"", line));
    Image image{0, 0, 3, {}};
    if (std::sscanf(line.c_str(), "-Y %9d +X %9d", &image.height, &image.width) != 2)
        reader.fail(fmt::format("found \"{:.40}\", expected \"-Y height +X width\"", line));
    formats::check_size(reader.name, "HDR", image.width, image.height, 3);
    return image;
}

/// One component of a row: runs (length + 128, value) and literals (length, values).
void read_runs(HdrReader& reader, std::uint8_t* row, std::size_t width) {
    for (std::size_t x = 0; x < width;) {
        reader.begin = reader.offset;
        const int code = next_byte(reader);
        const auto length = static_cast<std::size_t>(code > 128 ? code - 128 : code);
        if (length == 0 || length > width - x)
            reader.fail(
                fmt::format("found a run of {} pixels, expected 1 to {}", length, width - x));
        const int value = code > 128 ? next_byte(reader) : 0;
        for (const std::size_t end = x + length; x < end; ++x)
            row[4 * x] = static_cast<std::uint8_t>(code > 128 ? value : next_byte(reader));
    }
}

/// In files of the first kind a pixel (1, 1, 1, n) repeats the one before it. It is no colour: one
/// component of that is 128 or more.
void refuse_old_runs(const HdrReader& reader, const std::vector<std::uint8_t>& row) {
    for (std::size_t i = 0; i < row.size(); i += 4)
        if (row[i] == 1 && row[i + 1] == 1 && row[i + 2] == 1)
            reader.refuse("found a run of whole pixels, expected flat rows or runs of a component");
}

void read_row(HdrReader& reader, std::vector<std::uint8_t>& row) {
    const std::size_t width = row.size() / 4;
    reader.begin = reader.offset;
    const std::string_view rest = reader.bytes.substr(reader.offset);
    if (width >= 8 && width < 32768 && rest.size() >= 4 && rest[0] == 2 && rest[1] == 2 &&
        (rest[2] & 0x80) == 0) {
        reader.offset += 2;
        const int high = next_byte(reader), length = high * 256 + next_byte(reader);
        if (length != static_cast<int>(width))
            reader.fail(fmt::format("found a row of {} pixels, expected {}", length, width));
        for (std::size_t c = 0; c < 4; ++c) read_runs(reader, row.data() + c, width);
    } else {
        for (std::uint8_t& value : row) value = static_cast<std::uint8_t>(next_byte(reader));
        refuse_old_runs(reader, row);
    }
}

void convert_xyz(Image& image) {
    for (std::size_t i = 0; i < image.values.size(); i += 3) {
        float* color = image.values.data() + i;
        const double xyz[3] = {color[0], color[1], color[2]};
        for (int c = 0; c < 3; ++c)
            color[c] =
                static_cast<float>(kRec709OfXyz[c][0] * xyz[0] + kRec709OfXyz[c][1] * xyz[1] +
                                   kRec709OfXyz[c][2] * xyz[2]);
    }
}

}  // namespace

ImageFile formats::decode_hdr(const std::string& name, std::string_view bytes, FileColors colors,
                              Content content) {
    HdrReader reader{name, bytes};
    Image image = read_header(reader);
    const auto width = static_cast<std::size_t>(image.width);
    // A run holds at most 127 pixels: what is left must be able to hold the image.
    if ((bytes.size() - reader.offset) < width * static_cast<std::size_t>(image.height) / 127)
        reader.fail_at_end();
    if (content == Content::kHeader) return {std::move(image), PixelEncoding::kFloat, "HDR", 8};
    image.values.resize(image.index(0, image.height));
    std::vector<std::uint8_t> row(4 * width);
    for (int y = 0; y < image.height; ++y) {
        read_row(reader, row);
        for (std::size_t x = 0; x < width; ++x) {
            const float scale = row[4 * x + 3] == 0 ? 0.0f : std::ldexp(1.0f, row[4 * x + 3] - 136);
            for (std::size_t c = 0; c < 3; ++c)
                image.values[image.index(0, y) + 3 * x + c] =
                    static_cast<float>(row[4 * x + c]) * scale;
        }
    }
    if (reader.is_xyz && colors == FileColors::kRec709) convert_xyz(image);
    return {std::move(image), PixelEncoding::kFloat, "HDR", 8};
}

}  // namespace burnish
