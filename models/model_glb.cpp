#include "models/model_glb.h"

#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "core/parallel.h"
#include "core/transform.h"
#include "core/version.h"
#include "models/gltf_material.h"
#include "models/gltf_mesh.h"

namespace burnish {

namespace {

GltfJson primitive_of(GltfModel& model, const Mesh& mesh, const std::vector<UvTransform>& uv_sets,
                      int material) {
    GltfJson attributes{{"POSITION", add_positions(model, mesh.positions)}};
    if (!mesh.normals.empty()) attributes["NORMAL"] = add_normals(model, mesh.normals);
    std::size_t set = 0;
    for (const UvTransform& to_uv : uv_sets) {
        // v runs downwards in both, with row 0 of a picture at v = 0.
        std::vector<Vec2f> uvs = mesh.uvs;
        for (Vec2f& uv : uvs) uv = transform_uv(to_uv, uv);
        attributes["TEXCOORD_" + std::to_string(set++)] = add_uvs(model, uvs);
    }
    std::vector<std::uint32_t> indices;
    for (const Triangle& t : mesh.triangles)
        indices.insert(indices.end(), t.vertex.begin(), t.vertex.end());
    return {{"attributes", attributes},
            {"indices", add_indices(model, indices)},
            {"material", material}};
}

void add_node(GltfModel& model, const GltfJson& node) {
    model.json["scenes"][0]["nodes"].push_back(model.json["nodes"].size());
    model.json["nodes"].push_back(node);
}

/// Those of materials; shapes share them.
using Surfaces = std::map<int, GltfSurface>;

/// Pictures take time to compress: one material beside another.
Surfaces make_surfaces(const Scene& scene, const TextureTable& textures) {
    Surfaces surfaces;
    for (const Shape& shape : scene.shapes) surfaces[shape.material.value];
    std::vector<Surfaces::value_type*> all;
    for (auto& s : surfaces) all.push_back(&s);
    parallel_tasks(all.size(), [&](std::size_t i) {
        all[i]->second = make_surface(scene, textures, {all[i]->first});
    });
    return surfaces;
}

void add_shape(GltfModel& model, const Scene& scene, Surfaces& surfaces, const Shape& shape) {
    const Mesh mesh = triangles_of(scene, shape);
    if (mesh.triangles.empty()) return;
    GltfSurface& surface = surfaces.at(shape.material.value);
    add_textures(model, surface);
    const int material = add_material(model, scene, surface, shape);
    model.json["meshes"].push_back(
        {{"name", shape.id},
         {"primitives", GltfJson::array({primitive_of(model, mesh, surface.uv_sets, material)})}});
    add_node(model, {{"name", shape.id}, {"mesh", model.json["meshes"].size() - 1}});
}

/// Ours looks along +z with +x to the left, glTF's along -z with +x to the right.
void add_camera(GltfModel& model, const SceneSensor& sensor) {
    const double aspect = static_cast<double>(sensor.film.width) / sensor.film.height;
    const double half_x = sensor.camera.fov_x / 2 * std::numbers::pi / 180,
                 half_width = sensor.camera.orthographic_width / 2;
    GltfJson camera{{"znear", sensor.camera.near_clip}, {"zfar", sensor.camera.far_clip}};
    if (half_width > 0)
        camera["xmag"] = half_width, camera["ymag"] = half_width / aspect;
    else
        camera["aspectRatio"] = aspect, camera["yfov"] = 2 * std::atan(std::tan(half_x) / aspect);
    const char* const type = half_width > 0 ? "orthographic" : "perspective";
    model.json["cameras"].push_back({{"name", sensor.id}, {"type", type}, {type, camera}});
    const Transform to_world = sensor.camera.to_world * scaling({-1, 1, -1});
    GltfJson matrix = GltfJson::array();
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) matrix.push_back(to_world(row, column));
    add_node(
        model,
        {{"name", sensor.id}, {"camera", model.json["cameras"].size() - 1}, {"matrix", matrix}});
}

}  // namespace

std::string model_glb(const Scene& scene, const TextureTable& textures) {
    GltfModel model;
    model.json = {{"asset", {{"version", "2.0"}, {"generator", "Burnish " + version()}}},
                  {"scene", 0},
                  {"scenes", GltfJson::array({GltfJson::object()})}};
    Surfaces surfaces = make_surfaces(scene, textures);
    for (const Shape& shape : scene.shapes) add_shape(model, scene, surfaces, shape);
    for (const SceneSensor& sensor : scene.sensors) add_camera(model, sensor);
    return glb_bytes(std::move(model));
}

}  // namespace burnish
