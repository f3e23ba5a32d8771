#include "scenes/scene_files.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <fstream>

#include "burnish/core/error.h"

namespace burnish::procedural {

static_assert(std::endian::native == std::endian::little, "ply_bytes writes memory as it lies");

void write_whole_file(const std::filesystem::path& file, const std::string& bytes) {
    const std::filesystem::path temporary = file.string() + ".part";
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    std::error_code error;
    if (out) std::filesystem::rename(temporary, file, error);
    if (!out || error) {
        std::filesystem::remove(temporary, error);
        throw InputError(fmt::format("{}: cannot be written", file.string()));
    }
}

namespace {

template <class Value>
void append(std::string& bytes, const Value& value) {
    char raw[sizeof(Value)];
    std::memcpy(raw, &value, sizeof(Value));
    bytes.append(raw, sizeof(Value));
}

}  // namespace

std::string ply_bytes(const PatchMesh& mesh) {
    std::string bytes = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property float nx\nproperty float ny\nproperty float nz\n"
        "property float u\nproperty float v\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.positions.size(), mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        append(bytes, mesh.positions[i]);
        append(bytes, mesh.normals[i]);
        append(bytes, mesh.uvs[i]);
    }
    for (const auto& triangle : mesh.triangles) {
        append(bytes, std::uint8_t{3});
        append(bytes, triangle);
    }
    return bytes;
}

}  // namespace burnish::procedural
