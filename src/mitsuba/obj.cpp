// tinyobjloader parses the lines; its callback interface hands over the indices as written, so that
// faces stay whole (fans, not its own triangulation) and are checked here with the line at hand.
#include "mitsuba/obj.h"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <string_view>
#include <unordered_map>

#include "burnish/error.h"
#include "core/parsed.h"
#include "image/files.h"
#include "mitsuba/numbers.h"

namespace burnish::mitsuba {

namespace {

/// Indices of position, texture coordinate and normal; -1: none.
using Corner = std::array<std::int32_t, 3>;

struct CornerHash {
    std::size_t operator()(const Corner& c) const {
        std::uint64_t hash = 0;
        for (const std::int32_t i : c)
            hash = (hash ^ static_cast<std::uint32_t>(i)) * 0x9E3779B97F4A7C15u;
        return static_cast<std::size_t>(hash ^ (hash >> 32));
    }
};

struct ObjReader {
    std::string name;
    const std::string& text;
    std::istringstream stream;
    std::size_t line_begin = 0;  ///< of the line after the last one that was counted
    int line = 0;
    std::vector<Vec3f> positions{}, normals{};
    std::vector<Vec2f> uvs{};
    std::unordered_map<Corner, std::uint32_t, CornerHash> vertices{};
    std::vector<Corner> corners{};  ///< per vertex of the mesh
    std::vector<Triangle> triangles{};
    std::size_t without_uv = 0, without_normal = 0;  ///< corners of faces
    std::size_t concave_faces = 0;
    std::set<std::string, std::less<>> materials{};

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}:{}: {}", name, line, what));
    }
};

/// Moves to the line that tinyobjloader has just read, and returns it.
std::string_view current_line(ObjReader& reader) {
    const std::streamoff position =
        reader.stream.eof() ? -1 : std::streamoff(reader.stream.tellg());
    const std::size_t end = position < 0 ? reader.text.size() : static_cast<std::size_t>(position);
    std::size_t begin = reader.line_begin;
    for (std::size_t i = reader.line_begin; i < end; ++i) {
        const bool is_end = reader.text[i] == '\n' ||
                            (reader.text[i] == '\r' && reader.text.substr(i + 1, 1) != "\n");
        if (!is_end && i + 1 != end) continue;
        ++reader.line;
        begin = reader.line_begin;
        reader.line_begin = i + 1;
    }
    return std::string_view(reader.text).substr(begin, end - begin);
}

/// tinyobjloader reads what is no number as zero: check the words of the line.
void check_numbers(const ObjReader& reader, std::string_view line, std::size_t minimum) {
    std::size_t found = 0;
    line.remove_prefix(std::min(line.find_first_of(" \t", line.find('v')), line.size()));
    for_words(line, " \t\r\n", [&](std::string_view word) {
        const std::optional<double> value = parsed<double>(without_plus(word));
        if (!value || !(std::abs(*value) < 1e38))
            reader.fail(fmt::format("found \"{:.40}\", expected a finite number", word));
        ++found;
    });
    if (found < minimum)
        reader.fail(fmt::format("found {} numbers, expected at least {}", found, minimum));
}

/// An index is a whole number that an int holds; empty: none is given.
bool is_index(std::string_view word) { return word.empty() || parsed<int>(without_plus(word)); }

/// The first word of a text, which it leaves; words are parted by one of `separators`.
std::string_view take_word(std::string_view& text, const char* separators) {
    const std::size_t end = std::min(text.find_first_of(separators), text.size());
    const std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return word;
}

/// Slashes that end a corner become blanks: tinyobjloader looks for an index behind them, and takes
/// that of the next corner. word: of the line.
void blank_last_slashes(std::span<char> line, std::string_view word) {
    const std::size_t kept = word.find_last_not_of('/') + 1;
    if (kept == 0) return;  // no corner, which is refused later
    const auto begin = static_cast<std::size_t>(word.data() - line.data());
    std::ranges::fill(line.subspan(begin + kept, word.size() - kept), ' ');
}

/// A line of a face has vertices, with indices of vertices, texture coordinates and normals.
void check_face(const std::string& name, int number, std::span<char> text) {
    constexpr const char* kBlank = " \t";
    std::string_view line(text.data(), text.size());
    line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
    if (take_word(line, kBlank) != "f") return;
    bool has_vertices = false;
    while (!line.empty()) {
        const std::string_view word = take_word(line, kBlank);
        std::string_view indices = word;
        while (!indices.empty())
            if (!is_index(take_word(indices, "/")))
                throw InputError(
                    fmt::format("{}:{}: found \"{:.40}\", expected whole numbers between slashes",
                                name, number, word));
        has_vertices |= !word.empty();
        blank_last_slashes(text, word);
    }
    if (!has_vertices)
        throw InputError(
            fmt::format("{}:{}: found a face without vertices, expected at least 3", name, number));
}

/// A comment, which may end any line, becomes blanks: tinyobjloader reads it as indices. The name
/// of a material may have a "#" within.
void blank_comment(std::span<char> text) {
    const std::string_view line(text.data(), text.size());
    const std::size_t first = std::min(line.find_first_not_of(" \t"), line.size());
    const bool has_name = line.substr(first).starts_with("usemtl");
    const std::size_t at = has_name ? std::min(line.find(" #"), line.find("\t#")) : line.find('#');
    std::ranges::fill(text.subspan(std::min(at, line.size())), ' ');
}

/// tinyobjloader leaves out a face without vertices, and takes comments and what is no index for
/// indices: check the words of the faces, and leave what it reads rightly.
void prepare_lines(const std::string& name, std::string& text) {
    int line = 0;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find_first_of("\r\n", begin), text.size());
        const std::span<char> characters = std::span(text).subspan(begin, end - begin);
        blank_comment(characters);
        check_face(name, ++line, characters);
        begin = end + (text.compare(end, 2, "\r\n") == 0 ? 2 : 1);
    }
}

void on_position(void* user, float x, float y, float z, float) {
    auto& reader = *static_cast<ObjReader*>(user);
    check_numbers(reader, current_line(reader), 3);
    reader.positions.push_back({x, y, z});
}

void on_normal(void* user, float x, float y, float z) {
    auto& reader = *static_cast<ObjReader*>(user);
    check_numbers(reader, current_line(reader), 3);
    reader.normals.push_back({x, y, z});
}

void on_uv(void* user, float u, float v, float) {
    auto& reader = *static_cast<ObjReader*>(user);
    check_numbers(reader, current_line(reader), 1);
    reader.uvs.push_back({u, v});
}

void on_material(void* user, const char* name, int) {
    std::string_view rest = name;
    rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
    static_cast<ObjReader*>(user)->materials.emplace(
        rest.substr(0, rest.find_last_not_of(" \t") + 1));
}

/// An index of the file (from 1, negative from the end, 0 for none) -> from 0, -1 for none.
std::int32_t resolve_index(const ObjReader& reader, int index, std::size_t count,
                           const char* what) {
    const long long resolved = index > 0   ? index - 1LL
                               : index < 0 ? static_cast<long long>(count) + index
                                           : -1;
    if (index != 0 && (resolved < 0 || resolved >= static_cast<long long>(count)))
        reader.fail(
            fmt::format("found the {} index {}, but {} were given so far", what, index, count));
    return static_cast<std::int32_t>(resolved);
}

std::uint32_t vertex_of(ObjReader& reader, const tinyobj::index_t& index) {
    const Corner corner{
        resolve_index(reader, index.vertex_index, reader.positions.size(), "vertex"),
        resolve_index(reader, index.texcoord_index, reader.uvs.size(), "texture coordinate"),
        resolve_index(reader, index.normal_index, reader.normals.size(), "normal")};
    if (corner[0] < 0) reader.fail("found a face corner without a vertex, expected an index");
    reader.without_uv += corner[1] < 0;
    reader.without_normal += corner[2] < 0;
    const auto [entry, is_new] =
        reader.vertices.emplace(corner, static_cast<std::uint32_t>(reader.corners.size()));
    if (is_new) reader.corners.push_back(corner);
    return entry->second;
}

void on_face(void* user, tinyobj::index_t* indices, int count) {
    auto& reader = *static_cast<ObjReader*>(user);
    current_line(reader);
    if (count < 3)
        reader.fail(fmt::format("found a face of {} vertices, expected at least 3", count));
    std::vector<std::uint32_t> polygon, places;
    for (int i = 0; i < count; ++i) {
        polygon.push_back(vertex_of(reader, indices[i]));
        places.push_back(static_cast<std::uint32_t>(reader.corners[polygon.back()][0]));
    }
    reader.concave_faces += count > 3 && !is_convex(reader.positions, places);
    add_fan(reader.triangles, polygon);
}

template <class T>
T value_at(const std::vector<T>& values, std::int32_t index) {
    return index < 0 ? T{} : values[static_cast<std::size_t>(index)];
}

bool has(const ObjReader& reader, std::size_t kind) {
    return std::any_of(reader.corners.begin(), reader.corners.end(),
                       [&](const Corner& c) { return c[kind] >= 0; });
}

MeshFile to_mesh(ObjReader& reader) {
    MeshFile file;
    file.concave_faces = reader.concave_faces;
    file.materials = reader.materials.size();
    Mesh& mesh = file.mesh;
    for (const Corner& corner : reader.corners)
        mesh.positions.push_back(value_at(reader.positions, corner[0]));
    mesh.triangles = std::move(reader.triangles);
    if (has(reader, 1)) {
        for (const Corner& c : reader.corners) mesh.uvs.push_back(value_at(reader.uvs, c[1]));
        file.corners_without_uv = reader.without_uv;
    }
    if (!has(reader, 2)) return file;
    mesh.normals = smooth_normals(mesh);
    for (std::size_t i = 0; i < reader.corners.size(); ++i)
        if (const std::int32_t given = reader.corners[i][2]; given >= 0)
            mesh.normals[i] = value_at(reader.normals, given);
    file.corners_without_normal = reader.without_normal;
    return file;
}

}  // namespace

MeshFile read_obj_file(const std::filesystem::path& file) {
    std::string text = read_bytes(file);
    if (const std::size_t at = text.find('\0'); at != std::string::npos)
        throw InputError(
            fmt::format("{}: byte offset {}: found a NUL byte, expected the text of "
                        "an OBJ file",
                        file.string(), at));
    text = without_mark(std::move(text));
    prepare_lines(file.string(), text);
    ObjReader reader{file.string(), text, std::istringstream(text)};
    tinyobj::callback_t callback;
    callback.vertex_cb = on_position;
    callback.normal_cb = on_normal;
    callback.texcoord_cb = on_uv;
    callback.index_cb = on_face;
    callback.usemtl_cb = on_material;
    std::string error;
    if (!tinyobj::LoadObjWithCallback(reader.stream, callback, &reader, nullptr, nullptr, &error))
        reader.fail("malformed OBJ file: " + error);
    if (reader.triangles.empty())
        throw InputError(
            fmt::format("{}: found no faces, expected an OBJ file with at least one", reader.name));
    return to_mesh(reader);
}

}  // namespace burnish::mitsuba
