// Binary glTF 2.0 -> one mesh.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "burnish/error.h"
#include "cli/glb_file.h"
#include "cli/glb_material.h"
#include "cli/mesh_file.h"
#include "core/transform.h"
#include "models/gltf_numbers.h"
#include "shading/texture.h"

namespace burnish {

namespace {

/// The corners of the triangles: of a list, a strip or a fan.
std::vector<std::uint32_t> corners_of(const Glb& glb, const Value& primitive, std::size_t vertices,
                                      std::size_t mode) {
    std::vector<std::uint32_t> order;
    if (has(primitive, "indices")) {
        const Value place = member(primitive, "indices");
        const Accessor a = accessor(glb, place, "SCALAR", 1);
        for (std::size_t i = 0; i < a.count; ++i) {
            const double index = component(a, i, 0);
            if (!(index >= 0 && index < static_cast<double>(vertices)))
                fail(place,
                     fmt::format("indices below {}; number {} is {:.0f}", vertices, i, index));
            order.push_back(static_cast<std::uint32_t>(index));
        }
    } else {
        for (std::size_t i = 0; i < vertices; ++i) order.push_back(static_cast<std::uint32_t>(i));
    }
    constexpr std::size_t kStrip = 5;
    if (mode == 4) return order;
    std::vector<std::uint32_t> corners;
    for (std::size_t i = 2; i < order.size(); ++i) {
        const bool swaps = mode == kStrip && i % 2 == 1;
        const std::uint32_t a = mode == kStrip ? order[i - 2] : order[0], b = order[i - 1];
        for (const std::uint32_t v : {swaps ? b : a, swaps ? a : b, order[i]}) corners.push_back(v);
    }
    return corners;
}

/// What of all primitives is known so far.
struct Reader {
    const Glb& glb;
    FoundMesh file;
    std::set<const nlohmann::json*> nodes;
    std::set<std::size_t> materials;
    std::size_t primitives = 0;         ///< of any kind, as often as nodes show them
    std::size_t vertices_read = 0;      ///< of triangles, whether they are kept or not
    std::size_t others = 0;             ///< points and lines
    std::set<std::string> unread = {};  ///< a sentence for each kind of what changes a mesh
    std::string without_uvs = {};       ///< the first primitive without texture coordinates
};

/// What a primitive's attribute of that name holds, `components` floats for each of `count`
/// vertices; empty without it.
std::vector<float> attribute(const Glb& glb, const Value& attributes, const char* name,
                             std::size_t components, std::size_t count) {
    std::vector<float> values;
    if (!has(attributes, name)) return values;
    const Value place = member(attributes, name);
    const Accessor a = accessor(glb, place, components == 3 ? "VEC3" : "VEC2", components);
    if (a.count != count) fail(place, fmt::format("{} elements, as POSITION has", count));
    for (std::size_t i = 0; i < a.count; ++i)
        for (std::size_t c = 0; c < components; ++c) {
            values.push_back(static_cast<float>(component(a, i, c)));
            if (!std::isfinite(values.back()))
                fail(place, fmt::format("finite numbers; element {} is not", i));
        }
    return values;
}

std::size_t vertices_of(const Glb& glb, const Value& primitive) {
    require_member(primitive, "attributes");
    const Value attributes = member(primitive, "attributes");
    require_member(attributes, "POSITION");
    return accessor(glb, member(attributes, "POSITION"), "VEC3", 3).count;
}

/// count: of its vertices.
Mesh read_primitive(const Glb& glb, const Value& primitive, std::size_t mode, std::size_t count) {
    const Value attributes = member(primitive, "attributes");
    const std::vector<float> positions = attribute(glb, attributes, "POSITION", 3, count),
                             normals = attribute(glb, attributes, "NORMAL", 3, count),
                             uvs = attribute(glb, attributes, "TEXCOORD_0", 2, count);
    Mesh mesh;
    for (std::size_t i = 0; i + 2 < positions.size(); i += 3)
        mesh.positions.push_back({positions[i], positions[i + 1], positions[i + 2]});
    for (std::size_t i = 0; i + 2 < normals.size(); i += 3)
        mesh.normals.push_back({normals[i], normals[i + 1], normals[i + 2]});
    for (std::size_t i = 0; i + 1 < uvs.size(); i += 2) mesh.uvs.push_back({uvs[i], uvs[i + 1]});
    const std::vector<std::uint32_t> corners = corners_of(glb, primitive, count, mode);
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
        mesh.triangles.push_back({{corners[i], corners[i + 1], corners[i + 2]}});
    return mesh;
}

/// The same with vertices of its own for each triangle, which have the normal of its face: what a
/// primitive without normals looks like.
Mesh with_face_normals(const Mesh& shared) {
    Mesh mesh;
    for (const Triangle& t : shared.triangles) {
        const auto corner = [&](std::size_t i) { return to_double(shared.positions[t.vertex[i]]); };
        const Vec3<double> n = cross(corner(1) - corner(0), corner(2) - corner(0));
        const double area = length(n);
        const Vec3f normal = area > 0 ? to_float(n / area) : Vec3f{1, 0, 0};
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const std::uint32_t v : t.vertex) {
            mesh.positions.push_back(shared.positions[v]);
            mesh.normals.push_back(normal);
            if (!shared.uvs.empty()) mesh.uvs.push_back(shared.uvs[v]);
        }
        mesh.triangles.push_back({{first, first + 1, first + 2}});
    }
    return mesh;
}

/// The triangles keep their front under a mirror. Normals of 0 0 0 stay what they are.
void append(const Mesh& part, const Transform& to_world, Mesh& mesh) {
    const bool mirrors = determinant3(to_world) < 0;
    const Transform to_local = inverse(to_world);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3f& p : part.positions) mesh.positions.push_back(transform_point(to_world, p));
    for (const Vec3f& n : part.normals)
        mesh.normals.push_back(n == Vec3f{} ? n : transform_normal(to_local, n));
    mesh.uvs.insert(mesh.uvs.end(), part.uvs.begin(), part.uvs.end());
    for (Triangle t : part.triangles) {
        for (std::uint32_t& v : t.vertex) v += first;
        if (mirrors) std::swap(t.vertex[1], t.vertex[2]);
        mesh.triangles.push_back(t);
    }
}

/// How many primitives, vertices and triangles each a file may have in all. Nodes and primitives
/// may share what it holds, so that a small file could have any number.
std::size_t max_of(const Glb& glb) {
    constexpr std::size_t kMax = 100'000'000, kAlways = 1'000'000, kPerByte = 16;
    return std::min(kMax, std::max(kAlways, kPerByte * glb.bytes.size()));
}

/// Where it stands, and the mesh's name.
std::string named_place(const Value& mesh, const Value& primitive) {
    if (!has(mesh, "name")) return primitive.key;
    return fmt::format(
        "{} ({})", primitive.key,
        member(mesh, "name").value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

/// Texture coordinates of integers become those at which the material's first texture is read: its
/// transform brings back what their exporter scaled to few bits.
void apply_material(const Value& primitive, Mesh& part, Reader& reader) {
    if (!has(primitive, "material")) return;
    const std::size_t index = whole(member(primitive, "material"), 1e9);
    const GlbMaterial material = read_material(reader.glb, index);
    reader.materials.insert(index);
    reader.file.is_double_sided |= material.is_double_sided;
    if (part.uvs.empty()) return;
    if (material.uv_set != 0) {
        reader.unread.insert(
            fmt::format("TEXCOORD_{} is not read, at which a material has its textures: "
                        "TEXCOORD_0 counts",
                        material.uv_set));
        return;
    }
    const Value uvs = member(member(primitive, "attributes"), "TEXCOORD_0");
    if (accessor(reader.glb, uvs, "VEC2", 2).type != gltf::kFloat) {
        for (Vec2f& uv : part.uvs) uv = transform_uv(material.to_uv, uv);
    } else if (material.to_uv.m != UvTransform{}.m) {
        reader.unread.insert("KHR_texture_transform is not read: TEXCOORD_0 counts as it is");
    }
}

void add_primitive(const Value& mesh, std::size_t index, const Transform& to_world,
                   Reader& reader) {
    constexpr std::size_t kTriangles = 4, kFan = 6;
    const Value primitive = element(member(mesh, "primitives"), index);
    const std::size_t mode = whole_or(primitive, "mode", kTriangles, kFan);
    const std::size_t max = max_of(reader.glb);
    if (++reader.primitives > max)
        fail(primitive, fmt::format("at most {} primitives in all", max));
    if (mode < kTriangles) {
        ++reader.others;
        return;
    }
    const std::size_t count = vertices_of(reader.glb, primitive);
    reader.vertices_read += count;
    if (reader.vertices_read > max) fail(primitive, fmt::format("at most {} vertices in all", max));
    Mesh part = read_primitive(reader.glb, primitive, mode, count);
    const Mesh& read = reader.file.mesh;
    const std::size_t vertices =
        part.normals.empty() ? 3 * part.triangles.size() : part.positions.size();
    if (read.positions.size() + vertices > max)
        fail(primitive, fmt::format("at most {} vertices in all", max));
    if (read.triangles.size() + part.triangles.size() > max)
        fail(primitive, fmt::format("at most {} triangles in all", max));
    apply_material(primitive, part, reader);
    if (part.normals.empty()) part = with_face_normals(part);
    append(part, to_world, reader.file.mesh);
    if (!has(member(primitive, "attributes"), "TEXCOORD_0") && reader.without_uvs.empty())
        reader.without_uvs = named_place(mesh, primitive);
    if (has(primitive, "targets"))
        reader.unread.insert("morph targets are not read: a mesh has its shape without them");
}

Transform local_transform(const Value& node) {
    Transform t;
    if (has(node, "matrix")) {
        const std::vector<double> m = numbers(member(node, "matrix"), 16);
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column)
                t(row, column) = m[static_cast<std::size_t>(4 * column + row)];
        return t;
    }
    const auto values = [&](const char* name, std::vector<double> otherwise) {
        return has(node, name) ? numbers(member(node, name), otherwise.size()) : otherwise;
    };
    const std::vector<double> move = values("translation", {0, 0, 0}),
                              turn = values("rotation", {0, 0, 0, 1}),
                              size = values("scale", {1, 1, 1});
    const double norm = std::hypot(std::hypot(turn[0], turn[1]), std::hypot(turn[2], turn[3]));
    constexpr double kRounding = 1e-3;
    if (!(std::abs(norm - 1) <= kRounding))
        fail(member(node, "rotation"), "a quaternion of length 1");
    t = rotation(turn[3] / norm, turn[0] / norm, turn[1] / norm, turn[2] / norm);
    return translation({move[0], move[1], move[2]}) * t * scaling({size[0], size[1], size[2]});
}

/// Of what is flattened, rounding may leave a determinant that is not 0.
bool has_inverse(const Transform& a) {
    try {
        inverse(a);
        return std::abs(determinant3(a)) > 0;
    } catch (const std::domain_error&) {
        return false;
    }
}

void note_unread(const Value& node, Reader& reader) {
    constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";
    if (has(node, "skin"))
        reader.unread.insert(
            "skins are not read: a mesh has the shape in which it was bound to them");
    if (has(node, "extensions") && has(member(node, "extensions"), kInstancing))
        reader.unread.insert(
            fmt::format("{} is not read: a mesh stands once for each node", kInstancing));
}

/// depth: of the nodes above.
void add_node(const Value& index, const Transform& parent, int depth, Reader& reader) {
    constexpr int kMaxDepth = 256;
    const Value node = entry(reader.glb, "nodes", index);
    if (!reader.nodes.insert(&node.value).second) fail(index, "a node that nothing else names");
    if (depth > kMaxDepth)
        fail(index, fmt::format("at most {} nodes within each other", kMaxDepth));
    const Transform to_world = parent * local_transform(node);
    if (has(node, "mesh")) {
        const Value mesh = entry(reader.glb, "meshes", member(node, "mesh"));
        if (!has_inverse(to_world)) fail(node, "a transform that has an inverse");
        note_unread(node, reader);
        const std::size_t first = reader.file.mesh.positions.size();
        for (std::size_t i = 0; i < count_of(mesh, "primitives"); ++i)
            add_primitive(mesh, i, to_world, reader);
        if (find_far_vertex(reader.file.mesh, first) < reader.file.mesh.positions.size())
            fail(node,
                 fmt::format("vertices within {:g} of the origin: scale the mesh", kMaxMeshReach));
    }
    for (std::size_t i = 0; i < count_of(node, "children"); ++i)
        add_node(element(member(node, "children"), i), to_world, depth + 1, reader);
}

void add_scene(Reader& reader) {
    const Value all = document(reader.glb);
    const nlohmann::json first = 0;
    const Value scene =
        entry(reader.glb, "scenes",
              has(all, "scene") ? member(all, "scene") : Value{first, all.file, "scene"});
    for (std::size_t i = 0; i < count_of(scene, "nodes"); ++i)
        add_node(element(member(scene, "nodes"), i), {}, 0, reader);
}

/// Whether what it asks for is read, or does not matter here: materials, textures and lights.
bool is_known(const std::string& extension) {
    for (const char* start : {"KHR_materials_", "KHR_texture_", "EXT_texture_"})
        if (extension.starts_with(start)) return true;
    return extension == "KHR_mesh_quantization" || extension == "KHR_lights_punctual";
}

void check_extensions(const Glb& glb) {
    for (std::size_t i = 0; i < count_of(document(glb), "extensionsRequired"); ++i) {
        const Value required = element(member(document(glb), "extensionsRequired"), i);
        const std::string name = text(required);
        if (is_known(name)) continue;
        fail(required, name.find("compression") != std::string::npos
                           ? "a file without it: export it without compression"
                           : "a file without this extension, which is not read");
    }
}

/// The data lies within the file.
void check_data(const Glb& glb) {
    if (count_of(document(glb), "buffers") == 0) return;
    const Value buffer = element(member(document(glb), "buffers"), 0);
    if (has(buffer, "uri"))
        fail(member(buffer, "uri"), "the data in the file's own chunk: export it as one .glb");
}

}  // namespace

FoundMesh read_glb(const std::filesystem::path& file) {
    const Glb glb = open_glb(file);
    check_extensions(glb);
    check_data(glb);
    Reader reader{glb, {}, {}, {}};
    add_scene(reader);
    FoundMesh& read = reader.file;
    if (read.mesh.triangles.empty()) fail(document(glb), "a scene with triangles");
    if (!reader.without_uvs.empty() && !read.mesh.uvs.empty())
        throw InputError(fmt::format(
            "{}: {} has no TEXCOORD_0, which others have: unwrap it and export it again", glb.name,
            reader.without_uvs));
    if (reader.others > 0)
        read.notes.push_back(
            fmt::format("{} primitives of points or lines are left out", reader.others));
    for (const std::string& text : reader.unread) read.notes.push_back(text);
    if (reader.materials.size() > 1)
        read.notes.push_back(note_of_materials(reader.materials.size()));
    return std::move(read);
}

}  // namespace burnish
