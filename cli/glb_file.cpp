#include "cli/glb_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>

#include "burnish/error.h"
#include "core/bytes.h"
#include "image/files.h"
#include "models/gltf_numbers.h"

namespace burnish {

namespace {

[[noreturn]] void fail_at(const Glb& glb, std::size_t offset, const std::string& what) {
    throw InputError(fmt::format("{}: byte offset {}: {}", glb.name, offset, what));
}

/// The content of the chunk at an offset, which moves behind it.
std::string_view read_chunk(const Glb& glb, std::uint32_t type, const char* what,
                            std::size_t& offset) {
    if (glb.bytes.size() - offset < 8)
        fail_at(glb, offset,
                fmt::format("the file ends too early, expected the chunk of its {}", what));
    const std::uint64_t length = number_at(glb.bytes, offset, 4);
    const std::uint64_t found = number_at(glb.bytes, offset + 4, 4);
    if (found != type)
        fail_at(glb, offset + 4,
                fmt::format("found a chunk of type {:#x}, expected that of its {}", found, what));
    if (length > glb.bytes.size() - offset - 8)
        fail_at(glb, offset,
                fmt::format("found a chunk of {} bytes, but {} follow", length,
                            glb.bytes.size() - offset - 8));
    const std::string_view content = std::string_view(glb.bytes).substr(offset + 8, length);
    offset += 8 + length;
    return content;
}

std::size_t size_of_component(const Value& v) {
    switch (whole(v, 1e6)) {
        case gltf::kInt8:
        case gltf::kUint8:
            return 1;
        case gltf::kInt16:
        case gltf::kUint16:
            return 2;
        case gltf::kUint32:
        case gltf::kFloat:
            return 4;
        default:
            fail(v, "5120 to 5123, 5125 or 5126");
    }
}

}  // namespace

Glb open_glb(const std::filesystem::path& file) {
    Glb glb{file.string(), read_bytes(file), {}};
    if (glb.bytes.size() < 12 || number_at(glb.bytes, 0, 4) != gltf::kMagic)
        fail_at(glb, 0, "found no binary glTF, expected the letters glTF");
    if (const std::uint64_t version = number_at(glb.bytes, 4, 4); version != 2)
        fail_at(glb, 4, fmt::format("found version {}, expected 2", version));
    std::size_t offset = 12;
    const std::string_view text = read_chunk(glb, gltf::kJsonChunk, "JSON", offset);
    glb.json = parse_json(text, glb.name, offset - text.size(), "the JSON of a glTF");
    if (offset < glb.bytes.size()) {
        glb.data = offset + 8;
        glb.data_size = read_chunk(glb, gltf::kBinaryChunk, "data", offset).size();
    }
    return glb;
}

std::size_t whole(const Value& v, double max) {
    const double n = number(v);
    if (!(n >= 0 && n <= max && n == std::floor(n)))
        fail(v, fmt::format("a whole number from 0 to {:.0f}", max));
    return static_cast<std::size_t>(n);
}

std::size_t whole_or(const Value& object, const char* name, std::size_t otherwise, double max) {
    return has(object, name) ? whole(member(object, name), max) : otherwise;
}

std::size_t count_of(const Value& object, const char* name) {
    if (!has(object, name)) return 0;
    const Value array = member(object, name);
    if (!array.value.is_array()) fail(array, "an array");
    return array.value.size();
}

Value entry(const Glb& glb, const char* array, const Value& index) {
    const std::size_t count = count_of(document(glb), array);
    if (count == 0) fail(index, fmt::format("'{}' in the document", array));
    const Value found =
        element(member(document(glb), array), whole(index, static_cast<double>(count) - 1));
    if (!found.value.is_object()) fail(found, "an object");
    return found;
}

Accessor accessor(const Glb& glb, const Value& index, const std::string& type,
                  std::size_t components) {
    constexpr double kMax = 4294967295.0;
    const Value a = entry(glb, "accessors", index);
    if (has(a, "sparse") || !has(a, "bufferView"))
        fail(a, "an accessor with a bufferView, not sparse");
    require_member(a, "type"), require_member(a, "componentType"), require_member(a, "count");
    if (text(member(a, "type")) != type) fail(member(a, "type"), "\"" + type + "\"");
    const std::size_t size = size_of_component(member(a, "componentType"));
    const Value view = entry(glb, "bufferViews", member(a, "bufferView"));
    require_member(view, "buffer"), require_member(view, "byteLength");
    if (whole(member(view, "buffer"), kMax) != 0)
        fail(member(view, "buffer"), "0: the file's own chunk; export it as one .glb");
    const std::size_t begin = whole_or(view, "byteOffset", 0, kMax),
                      length = whole(member(view, "byteLength"), kMax),
                      offset = whole_or(a, "byteOffset", 0, kMax);
    Accessor result;
    result.count = whole(member(a, "count"), kMax);
    result.stride = whole_or(view, "byteStride", size * components, 252);
    result.type = whole(member(a, "componentType"), 1e6);
    result.normalized = has(a, "normalized") && member(a, "normalized").value == true;
    if (begin > glb.data_size || length > glb.data_size - begin)
        fail(view, fmt::format("a part of the {} bytes of data", glb.data_size));
    const std::size_t needed =
        result.count == 0 ? 0 : offset + (result.count - 1) * result.stride + size * components;
    if (result.stride < size * components || needed > length)
        fail(a, fmt::format("elements within the {} bytes of its bufferView", length));
    result.bytes =
        std::string_view(glb.bytes).substr(glb.data + begin).substr(std::min(offset, length));
    return result;
}

double component(const Accessor& a, std::size_t i, std::size_t c) {
    const auto read = [&]<class Number>(Number) -> double {
        const std::uint64_t bits =
            number_at(a.bytes, i * a.stride + c * sizeof(Number), sizeof(Number));
        if constexpr (std::is_floating_point_v<Number>) {
            return std::bit_cast<Number>(static_cast<std::uint32_t>(bits));
        } else {
            const double v = static_cast<Number>(bits);
            if (!a.normalized) return v;
            return std::max(-1.0, v / double{std::numeric_limits<Number>::max()});
        }
    };
    switch (a.type) {
        case gltf::kInt8:
            return read(std::int8_t{});
        case gltf::kUint8:
            return read(std::uint8_t{});
        case gltf::kInt16:
            return read(std::int16_t{});
        case gltf::kUint16:
            return read(std::uint16_t{});
        case gltf::kUint32:
            return read(std::uint32_t{});
        default:
            return read(0.0f);
    }
}

}  // namespace burnish
