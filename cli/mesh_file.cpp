#include "cli/mesh_file.h"

#include <fmt/format.h>

#include <cmath>

#include "burnish/error.h"
#include "image/files.h"
#include "mitsuba/mesh.h"
#include "mitsuba/obj.h"
#include "mitsuba/ply.h"

namespace burnish {

namespace {

/// Of a file whose v points upwards.
FoundMesh upward(mitsuba::MeshFile file) {
    FoundMesh found{std::move(file.mesh), mitsuba::corner_texts(file, false)};
    for (Vec2f& uv : found.mesh.uvs) uv.y = 1 - uv.y;
    if (file.concave_faces > 0)
        found.notes.push_back(
            fmt::format("{} of the faces with more than three corners are not convex: triangulate "
                        "them on export (Blender: Triangulated Mesh)",
                        file.concave_faces));
    if (file.materials > 1) found.notes.push_back(note_of_materials(file.materials));
    return found;
}

FoundMesh read_any(const std::filesystem::path& file) {
    const std::string extension = lower_extension(file);
    if (extension == ".obj") return upward(mitsuba::read_obj_file(file));
    if (extension == ".ply") return upward(mitsuba::read_ply_file(file, {.corner_uvs = true}));
    if (extension == ".glb") return read_glb(file);
    if (extension == ".gltf")
        throw InputError(fmt::format(
            "{}: a .gltf with files of its own is not read: export it as .glb, which is one file",
            file.string()));
    throw InputError(fmt::format("{}: found a file '{}', expected a mesh: .obj, .ply or .glb",
                                 file.string(), extension));
}

}  // namespace

std::string note_of_materials(std::size_t count) {
    return fmt::format("its {} materials become one, which shares one set of textures", count);
}

std::size_t find_far_vertex(const Mesh& mesh, std::size_t begin) {
    const auto is_far = [](float x) { return !(std::abs(x) <= kMaxMeshReach); };
    while (begin < mesh.positions.size()) {
        const Vec3f& p = mesh.positions[begin];
        if (is_far(p.x) || is_far(p.y) || is_far(p.z)) break;
        ++begin;
    }
    return begin;
}

FoundMesh read_mesh(const std::filesystem::path& file) {
    FoundMesh read = read_any(file);
    if (const std::size_t far = find_far_vertex(read.mesh); far < read.mesh.positions.size()) {
        const Vec3f& p = read.mesh.positions[far];
        throw InputError(
            fmt::format("{}: a vertex is at ({:.6g}, {:.6g}, {:.6g}), expected it "
                        "within {:g} of the origin: scale the mesh",
                        file.string(), p.x, p.y, p.z, kMaxMeshReach));
    }
    if (read.mesh.normals.empty()) read.mesh.normals = mitsuba::smooth_normals_of_places(read.mesh);
    if (const std::size_t count = mitsuba::fill_zero_normals(read.mesh))
        read.notes.push_back(mitsuba::zero_normals_text(count));
    read.mesh = mitsuba::finish_mesh(std::move(read.mesh), {});
    return read;
}

}  // namespace burnish
