#include "cli/mesh_file.h"

#include <fmt/format.h>

#include "burnish/error.h"
#include "image/files.h"
#include "mitsuba/mesh.h"
#include "mitsuba/obj.h"
#include "mitsuba/ply.h"

namespace burnish {

namespace {

FoundMesh upward(Mesh mesh) {
    for (Vec2f& uv : mesh.uvs) uv.y = 1 - uv.y;
    return {std::move(mesh), {}};
}

FoundMesh read_any(const std::filesystem::path& file) {
    const std::string extension = lower_extension(file);
    if (extension == ".obj") return upward(mitsuba::read_obj(file));
    if (extension == ".ply") return upward(mitsuba::read_ply(file, {.corner_uvs = true}));
    if (extension == ".glb") return read_glb(file);
    if (extension == ".gltf")
        throw InputError(fmt::format(
            "{}: a .gltf with files of its own is not read: export it as .glb, which is one file",
            file.string()));
    throw InputError(fmt::format("{}: found a file '{}', expected a mesh: .obj, .ply or .glb",
                                 file.string(), extension));
}

}  // namespace

FoundMesh read_mesh(const std::filesystem::path& file) {
    FoundMesh read = read_any(file);
    read.mesh = mitsuba::finish_mesh(std::move(read.mesh), {});
    return read;
}

}  // namespace burnish
