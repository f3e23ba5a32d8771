#include "mitsuba/ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "burnish/error.h"
#include "core/bytes.h"
#include "core/parsed.h"
#include "image/files.h"
#include "mitsuba/mesh.h"
#include "mitsuba/ply_attributes.h"
#include "mitsuba/ply_header.h"

namespace burnish::mitsuba {

namespace {

/// A cursor over the data of the file.
struct PlyReader {
    std::string name;
    std::string bytes;
    PlyFormat format = PlyFormat::kAscii;
    std::size_t offset = 0;
    std::size_t begin = 0;  ///< of the number that was read last
    int line = 1;           ///< of it; ASCII only
    std::size_t concave_faces = 0;
    std::set<std::uint64_t> textures = {};  ///< bits of the numbers of the faces' textures

    [[noreturn]] void fail(const std::string& what) const {
        if (format == PlyFormat::kAscii)
            throw InputError(fmt::format("{}:{}: {}", name, line, what));
        throw InputError(fmt::format("{}: byte offset {}: {}", name, begin, what));
    }
};

double read_ascii(PlyReader& reader) {
    const char* const end = reader.bytes.data() + reader.bytes.size();
    const char* p = reader.bytes.data() + reader.offset;
    for (; p != end && (*p == ' ' || *p == '\t' || *p == '\r' || *p == '\n'); ++p)
        reader.line += *p == '\n';
    reader.offset = static_cast<std::size_t>(p - reader.bytes.data());
    if (p == end) reader.fail("the file ends too early, expected a number");
    double value = 0;
    const std::string_view rest(p, static_cast<std::size_t>(end - p));
    const auto [next, error] = std::from_chars(without_plus(rest).data(), end, value);
    const std::string_view word(p, static_cast<std::size_t>(next - p));
    if (error == std::errc::result_out_of_range && !is_tiny(word))
        value = (*p == '-' ? -1 : 1) * std::numeric_limits<double>::infinity();
    const bool ends =
        next == end || *next == ' ' || *next == '\t' || *next == '\r' || *next == '\n';
    if ((error != std::errc() && error != std::errc::result_out_of_range) || !ends)
        reader.fail(fmt::format("found \"{:.12}\", expected a number", rest));
    reader.offset = static_cast<std::size_t>(next - reader.bytes.data());
    return value;
}

std::uint64_t read_bits(PlyReader& reader, std::size_t size) {
    reader.begin = reader.offset;
    if (reader.bytes.size() - reader.offset < size)
        reader.fail(fmt::format("the file ends too early, expected {} more bytes", size));
    const bool is_little = reader.format == PlyFormat::kLittleEndian;
    reader.offset += size;
    return number_at(reader.bytes, reader.begin, size,
                     is_little ? std::endian::little : std::endian::big);
}

double read_scalar(PlyReader& reader, PlyType type) {
    if (reader.format == PlyFormat::kAscii) return read_ascii(reader);
    const std::uint64_t bits = read_bits(reader, size_of(type));
    switch (type) {
        case PlyType::kInt8:
            return static_cast<std::int8_t>(bits);
        case PlyType::kUint8:
            return static_cast<std::uint8_t>(bits);
        case PlyType::kInt16:
            return static_cast<std::int16_t>(bits);
        case PlyType::kUint16:
            return static_cast<std::uint16_t>(bits);
        case PlyType::kInt32:
            return static_cast<std::int32_t>(bits);
        case PlyType::kUint32:
            return static_cast<std::uint32_t>(bits);
        case PlyType::kFloat32:
            return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
        case PlyType::kFloat64:
            break;
    }
    return std::bit_cast<double>(bits);
}

std::size_t read_list_size(PlyReader& reader, const PlyProperty& property) {
    const double count = read_scalar(reader, property.count_type);
    const std::size_t left = reader.bytes.size() - reader.offset;
    if (!(count >= 0) || count > static_cast<double>(left) || count != std::floor(count))
        reader.fail(fmt::format("found a list of {} values, but {} bytes follow", count, left));
    return static_cast<std::size_t>(count);
}

void skip(PlyReader& reader, const PlyProperty& property) {
    const std::size_t count = property.is_list ? read_list_size(reader, property) : 1;
    for (std::size_t i = 0; i < count; ++i) read_scalar(reader, property.type);
}

/// What a vertex property feeds: 0-2 position, 3-5 normal, 6-7 uv, -1 nothing.
int vertex_slot(const PlyProperty& property) {
    constexpr std::string_view kNames[8] = {"x", "y", "z", "nx", "ny", "nz", "u", "v"};
    const std::string& name = property.name;
    if (property.is_list) return -1;
    for (int i = 0; i < 8; ++i)
        if (name == kNames[i]) return i;
    if (name == "s" || name == "texture_u") return 6;
    if (name == "t" || name == "texture_v") return 7;
    return -1;
}

float checked(const PlyReader& reader, double value) {
    const auto result = static_cast<float>(value);
    if (!std::isfinite(result))
        reader.fail(fmt::format("found {}, expected a finite float", value));
    return result;
}

void read_vertices(PlyReader& reader, const PlyElement& element, Mesh& mesh,
                   AttributeColumns& columns) {
    columns = attribute_columns(element, "vertex_");
    std::vector<int> slots;
    bool has[8] = {};
    for (const PlyProperty& property : element.properties) {
        slots.push_back(vertex_slot(property));
        if (slots.back() >= 0) has[slots.back()] = true;
    }
    if (!has[0] || !has[1] || !has[2]) reader.fail("the vertices lack x, y or z");
    const bool has_normals = has[3] && has[4] && has[5], has_uvs = has[6] && has[7];
    mesh.positions.reserve(element.count);
    if (has_normals) mesh.normals.reserve(element.count);
    if (has_uvs) mesh.uvs.reserve(element.count);
    for (std::size_t row = 0; row < element.count; ++row) {
        float v[8] = {};
        for (std::size_t i = 0; i < slots.size(); ++i)
            if (slots[i] >= 0)
                v[slots[i]] = checked(reader, read_scalar(reader, element.properties[i].type));
            else if (columns.of_property[i] >= 0)
                columns.add(i, checked(reader, read_scalar(reader, element.properties[i].type)));
            else
                skip(reader, element.properties[i]);
        mesh.positions.push_back({v[0], v[1], v[2]});
        if (has_normals) mesh.normals.push_back({v[3], v[4], v[5]});
        if (has_uvs) mesh.uvs.push_back({v[6], v[7]});
    }
}

/// How many values the attributes of faces may have in all. Each triangle of a polygon has its own,
/// so that a small file could make any number.
std::size_t max_values(const PlyReader& reader) {
    constexpr std::size_t kAlways = 1'000'000, kPerByte = 16;
    return std::max(kAlways, kPerByte * reader.bytes.size());
}

/// Adds what was read of the face once for each of its triangles, and forgets it.
void repeat_for_triangles(const PlyReader& reader, AttributeColumns& columns,
                          std::size_t triangles) {
    std::size_t values = 0;
    for (const MeshAttribute& a : columns.attributes)
        values += a.values.size() - static_cast<std::size_t>(a.channels) +
                  triangles * static_cast<std::size_t>(a.channels);
    if (values > max_values(reader))
        reader.fail(fmt::format(
            "the attributes of the faces have {} values, one for each triangle, expected at most "
            "{}",
            values, max_values(reader)));
    for (MeshAttribute& a : columns.attributes) {
        const auto channels = static_cast<std::size_t>(a.channels);
        if (triangles == 0) a.values.resize(a.values.size() - channels);
        for (std::size_t k = 1; k < triangles; ++k)
            for (std::size_t c = 0; c < channels; ++c)
                a.values.push_back(a.values[a.values.size() - channels]);
    }
}

void read_polygon(PlyReader& reader, const PlyProperty& property, std::size_t vertices,
                  std::vector<std::uint32_t>& polygon) {
    const std::size_t corners = read_list_size(reader, property);
    if (corners < 3)
        reader.fail(fmt::format("found a face of {} vertices, expected at least 3", corners));
    polygon.resize(corners);
    for (std::uint32_t& index : polygon) {
        const double value = read_scalar(reader, property.type);
        if (!(value >= 0) || value >= static_cast<double>(vertices) || value != std::floor(value))
            reader.fail(fmt::format("found the vertex index {}, expected one in [0, {}]", value,
                                    static_cast<long long>(vertices) - 1));
        index = static_cast<std::uint32_t>(value);
    }
}

void read_corner_uvs(PlyReader& reader, const PlyProperty& property, std::vector<Vec2f>& uvs) {
    const std::size_t count = read_list_size(reader, property);
    if (count % 2 != 0)
        reader.fail(fmt::format("found {} texture coordinates of a face, expected pairs", count));
    uvs.resize(count / 2);
    for (Vec2f& uv : uvs) {
        uv.x = checked(reader, read_scalar(reader, property.type));
        uv.y = checked(reader, read_scalar(reader, property.type));
    }
}

/// Vertices apart by their texture coordinates.
struct CornerSplitter {
    Mesh mesh;  ///< with uvs
    std::map<std::tuple<std::uint32_t, float, float>, std::uint32_t> known;

    std::uint32_t vertex(const Mesh& from, std::uint32_t i, const Vec2f& uv) {
        const auto next = static_cast<std::uint32_t>(mesh.positions.size());
        const auto [at, is_new] = known.try_emplace({i, uv.x, uv.y}, next);
        if (is_new) {
            mesh.positions.push_back(from.positions[i]);
            if (!from.normals.empty()) mesh.normals.push_back(from.normals[i]);
            mesh.uvs.push_back(uv);
        }
        return at->second;
    }
};

/// split: where the corners' texture coordinates are asked for; null: they are not.
void read_faces(PlyReader& reader, const PlyElement& element, Mesh& mesh, CornerSplitter* split,
                AttributeColumns& columns) {
    columns = attribute_columns(element, "face_");
    mesh.triangles.reserve(element.count);
    std::vector<std::uint32_t> polygon;
    std::vector<Vec2f> uvs;
    for (std::size_t row = 0; row < element.count; ++row) {
        polygon.clear(), uvs.clear();
        for (std::size_t i = 0; i < element.properties.size(); ++i) {
            const PlyProperty& property = element.properties[i];
            if (property.is_list &&
                (property.name == "vertex_indices" || property.name == "vertex_index"))
                read_polygon(reader, property, mesh.positions.size(), polygon);
            else if (split && property.is_list && property.name == "texcoord")
                read_corner_uvs(reader, property, uvs);
            else if (columns.of_property[i] >= 0)
                columns.add(i, checked(reader, read_scalar(reader, property.type)));
            else if (!property.is_list && property.name == "texnumber")
                reader.textures.insert(
                    std::bit_cast<std::uint64_t>(read_scalar(reader, property.type)));
            else
                skip(reader, property);
        }
        repeat_for_triangles(reader, columns, polygon.size() < 3 ? 0 : polygon.size() - 2);
        add_fan(mesh.triangles, polygon);
        reader.concave_faces += polygon.size() > 3 && !is_convex(mesh.positions, polygon);
        if (!split) continue;
        if (uvs.size() != polygon.size())
            reader.fail(fmt::format("found {} texture coordinates of a face with {} vertices",
                                    uvs.size(), polygon.size()));
        for (std::size_t i = 0; i < polygon.size(); ++i)
            polygon[i] = split->vertex(mesh, polygon[i], uvs[i]);
        add_fan(split->mesh.triangles, polygon);
    }
}

double min_mesh_bytes(const PlyHeader& header) {
    double bytes = 0;
    for (const PlyElement& element : header.elements) {
        if (element.name == "vertex") bytes += min_bytes(element.count, 0);
        if (element.name == "face") bytes += min_bytes(0, element.count);
    }
    return bytes;
}

bool has_corner_uvs(const PlyElement& element) {
    return std::any_of(element.properties.begin(), element.properties.end(),
                       [](const PlyProperty& p) { return p.is_list && p.name == "texcoord"; });
}

}  // namespace

MeshFile read_ply_file(const std::filesystem::path& file, const PlyOptions& options) {
    PlyReader reader{file.string(), read_bytes(file)};
    const PlyHeader header = read_ply_header(reader.name, reader.bytes);
    if (options.before_mesh) options.before_mesh(min_mesh_bytes(header));
    reader.format = header.format;
    reader.offset = reader.begin = header.data_offset;
    reader.line = header.data_line;
    Mesh mesh;
    CornerSplitter corners;
    AttributeColumns of_vertices, of_faces;
    for (const PlyElement& element : header.elements) {
        if (element.name == "vertex") {
            if (!mesh.positions.empty()) reader.fail("found a second vertex element, expected one");
            read_vertices(reader, element, mesh, of_vertices);
        } else if (element.name == "face") {
            const bool split = options.corner_uvs && mesh.uvs.empty() && has_corner_uvs(element);
            if (!mesh.triangles.empty()) reader.fail("found a second face element, expected one");
            if (element.count > 0 && mesh.positions.empty())
                reader.fail("found no vertices before the faces, expected them first");
            read_faces(reader, element, mesh, split ? &corners : nullptr, of_faces);
        } else {
            for (std::size_t row = 0; row < element.count; ++row)
                for (const PlyProperty& property : element.properties) skip(reader, property);
        }
    }
    if (mesh.triangles.empty()) reader.fail("found no faces, expected at least one");
    MeshFile result;
    result.concave_faces = reader.concave_faces;
    result.materials = reader.textures.size();
    if (!corners.mesh.triangles.empty()) {
        result.mesh = std::move(corners.mesh);
        return result;
    }
    result.mesh = std::move(mesh);
    result.attributes = std::move(of_vertices.attributes);
    for (MeshAttribute& a : of_faces.attributes) result.attributes.push_back(std::move(a));
    return result;
}

}  // namespace burnish::mitsuba
