#include "mitsuba/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "burnish/error.h"
#include "core/parsed.h"
#include "mitsuba/numbers.h"

namespace burnish::mitsuba {

namespace {

struct HeaderReader {
    const std::string& name;
    std::string_view bytes;
    std::size_t offset = 0;
    int line = 0;

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}:{}: {}", name, std::max(line, 1), what));
    }
};

/// The words of the next line.
std::vector<std::string> next_line(HeaderReader& reader) {
    const std::size_t end = reader.bytes.find('\n', reader.offset);
    ++reader.line;
    if (end == std::string_view::npos || end - reader.offset > 4096)
        reader.fail("the PLY header does not end, expected end_header");
    const std::string_view text = reader.bytes.substr(reader.offset, end - reader.offset);
    reader.offset = end + 1;
    std::vector<std::string> words;
    for_words(text, " \t\r", [&](std::string_view word) { words.emplace_back(word); });
    return words;
}

PlyType read_type(const HeaderReader& reader, const std::string& word) {
    static const std::vector<std::pair<std::string, PlyType>> kTypes{
        {"char", PlyType::kInt8},      {"int8", PlyType::kInt8},
        {"uchar", PlyType::kUint8},    {"uint8", PlyType::kUint8},
        {"short", PlyType::kInt16},    {"int16", PlyType::kInt16},
        {"ushort", PlyType::kUint16},  {"uint16", PlyType::kUint16},
        {"int", PlyType::kInt32},      {"int32", PlyType::kInt32},
        {"uint", PlyType::kUint32},    {"uint32", PlyType::kUint32},
        {"float", PlyType::kFloat32},  {"float32", PlyType::kFloat32},
        {"double", PlyType::kFloat64}, {"float64", PlyType::kFloat64}};
    for (const auto& [type_name, type] : kTypes)
        if (type_name == word) return type;
    reader.fail(
        fmt::format("found the type \"{}\", expected a PLY type such as float or uchar", word));
}

PlyFormat read_format(const HeaderReader& reader, const std::vector<std::string>& words) {
    if (words.size() == 3 && words[2] == "1.0") {
        if (words[1] == "ascii") return PlyFormat::kAscii;
        if (words[1] == "binary_little_endian") return PlyFormat::kLittleEndian;
        if (words[1] == "binary_big_endian") return PlyFormat::kBigEndian;
    }
    reader.fail("expected \"format ascii|binary_little_endian|binary_big_endian 1.0\"");
}

PlyElement read_element(const HeaderReader& reader, const std::vector<std::string>& words) {
    if (words.size() != 3) reader.fail("expected \"element NAME COUNT\"");
    const std::optional<std::size_t> count = parsed<std::size_t>(words[2]);
    if (!count) reader.fail(fmt::format("found the count \"{:.40}\", expected a number", words[2]));
    return {words[1], *count, {}};
}

PlyProperty read_property(const HeaderReader& reader, const std::vector<std::string>& words) {
    if (words.size() == 3) return {words[2], read_type(reader, words[1]), false, PlyType::kUint8};
    if (words.size() != 5 || words[1] != "list")
        reader.fail("expected \"property TYPE NAME\" or \"property list COUNT_TYPE TYPE NAME\"");
    const PlyType count_type = read_type(reader, words[2]);
    if (count_type == PlyType::kFloat32 || count_type == PlyType::kFloat64)
        reader.fail(fmt::format("a list counts by \"{}\", expected an integer type", words[2]));
    return {words[4], read_type(reader, words[3]), true, count_type};
}

/// The fewest bytes that one row of the element takes in the file.
std::size_t minimum_bytes(const PlyElement& element, PlyFormat format) {
    std::size_t bytes = 0;
    for (const PlyProperty& property : element.properties)
        bytes += format == PlyFormat::kAscii
                     ? 2  // a digit and a blank
                     : size_of(property.is_list ? property.count_type : property.type);
    return std::max<std::size_t>(bytes, 1);
}

void check_counts(const HeaderReader& reader, const PlyHeader& header) {
    // The last blank of an ASCII file may be missing.
    std::size_t left =
        reader.bytes.size() - reader.offset + (header.format == PlyFormat::kAscii ? 1 : 0);
    for (const PlyElement& element : header.elements) {
        const std::size_t row = minimum_bytes(element, header.format);
        if (element.count > left / row || element.count > 0x7fffffffu)
            reader.fail(
                fmt::format("the header says {} {} rows of at least {} bytes, but {} bytes follow",
                            element.count, element.name, row, left));
        left -= element.count * row;
    }
}

}  // namespace

std::size_t size_of(PlyType type) {
    switch (type) {
        case PlyType::kInt8:
        case PlyType::kUint8:
            return 1;
        case PlyType::kInt16:
        case PlyType::kUint16:
            return 2;
        case PlyType::kInt32:
        case PlyType::kUint32:
        case PlyType::kFloat32:
            return 4;
        case PlyType::kFloat64:
            break;
    }
    return 8;
}

PlyHeader read_ply_header(const std::string& name, std::string_view bytes) {
    HeaderReader reader{name, bytes};
    PlyHeader header;
    bool has_format = false;
    if (const auto words = next_line(reader); words.size() != 1 || words[0] != "ply")
        reader.fail("found no \"ply\" line, expected a PLY file");
    while (true) {
        const std::vector<std::string> words = next_line(reader);
        if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
        if (words[0] == "end_header") break;
        if (words[0] == "format") {
            header.format = read_format(reader, words);
            has_format = true;
        } else if (words[0] == "element") {
            header.elements.push_back(read_element(reader, words));
        } else if (words[0] == "property" && !header.elements.empty()) {
            header.elements.back().properties.push_back(read_property(reader, words));
        } else {
            reader.fail(fmt::format(
                "found \"{:.40}\", expected format, element, property or end_header", words[0]));
        }
    }
    if (!has_format) reader.fail("the header has no format line");
    header.data_offset = reader.offset;
    header.data_line = reader.line + 1;
    check_counts(reader, header);
    return header;
}

}  // namespace burnish::mitsuba
