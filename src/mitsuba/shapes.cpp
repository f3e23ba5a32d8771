// Shapes: obj, ply, rectangle, cube, sphere, disk.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "burnish/error.h"
#include "mitsuba/loader.h"
#include "mitsuba/mesh.h"
#include "mitsuba/obj.h"
#include "mitsuba/ply.h"
#include "mitsuba/transforms.h"

namespace burnish::mitsuba {

namespace {

constexpr const char* kUnsupported =
    "bsplinecurve cylinder ellipsoids ellipsoidsmesh hair heightfield instance linearcurve merge "
    "sdfgrid serialized "
    "shapegroup";

Transform take_to_world(Properties& properties) {
    const Transform to_world = take_transform(properties, "to_world").value_or(Transform{});
    const double determinant = determinant3(to_world);
    if (!std::isfinite(determinant) || determinant == 0)
        fail(properties.node->place,
             "\"to_world\" of the shape has no inverse, expected an invertible transform");
    return to_world;
}

MeshOptions take_mesh_options(Properties& properties) {
    return {take_to_world(properties), take_boolean(properties, "face_normals", false),
            take_boolean(properties, "flip_normals", false)};
}

Mesh finish(const Properties& properties, Mesh mesh, const MeshOptions& options) {
    try {
        mesh = finish_mesh(std::move(mesh), options);
    } catch (const std::domain_error&) {
        fail(properties.node->place,
             "\"to_world\" of the shape has no inverse, expected an invertible transform");
    }
    if (!std::all_of(mesh.positions.begin(), mesh.positions.end(),
                     [](const Vec3f& p) { return is_finite(p); }))
        fail(properties.node->place,
             "\"to_world\" moves vertices to infinity, expected finite positions");
    return mesh;
}

Mesh read_mesh_file(const std::filesystem::path& file, const Properties& properties) {
    try {
        return properties.type == "obj" ? read_obj(file) : read_ply(file);
    } catch (const InputError& error) {
        fail(properties.node->place, error.what());
    }
}

Mesh load_mesh(Loader& loader, Properties& properties) {
    const std::string name = take_string(properties, "filename", "");
    if (name.empty())
        fail(properties.node->place,
             fmt::format("shape \"{}\" lacks the parameter \"filename\"", properties.type));
    const MeshOptions options = take_mesh_options(properties);
    const bool flip_uvs = take_boolean(properties, "flip_tex_coords", properties.type == "obj");
    Mesh mesh =
        read_mesh_file(resolve_file(loader.document, properties.node->place, name), properties);
    if (flip_uvs)
        for (Vec2f& uv : mesh.uvs) uv.y = 1 - uv.y;
    return finish(properties, std::move(mesh), options);
}

/// Rectangle and cube: flat faces, whose shading normals are the face normals.
Mesh flat_mesh(Properties& properties, Mesh mesh) {
    MeshOptions options = take_mesh_options(properties);
    options.face_normals = false;  // the normals decide the winding under a mirror
    mesh = finish(properties, std::move(mesh), options);
    mesh.normals.clear();
    return mesh;
}

Sphere read_sphere(Properties& properties) {
    const Vec3<double> center = take_point(properties, "center").value_or(Vec3<double>{});
    const double radius = take_number(properties, "radius", 1);
    if (radius == 0) fail(properties.node->place, "\"radius\" is 0, expected another value");
    const Transform to_world =
        take_to_world(properties) * translation(center) * scaling({radius, radius, radius});
    const UniformScale scale = uniform_scale(to_world, 1e-3);
    if (!scale.uniform)
        fail(
            properties.node->place,
            "\"to_world\" of the sphere shears or scales its axes differently, expected one scale");
    Sphere sphere;
    sphere.center = transform_point(to_world, {0, 0, 0});
    sphere.radius = static_cast<float>(scale.scale);
    sphere.to_world = orthonormalised(to_world);
    for (int i = 0; i < 3; ++i) sphere.to_world(i, 3) = 0;
    // As in Mitsuba, a mirrored sphere is inside out.
    sphere.flip_normals = take_boolean(properties, "flip_normals", false) != scale.mirrored;
    return sphere;
}

Disk read_disk(Properties& properties) {
    const Transform to_world = take_to_world(properties);
    return {to_world, inverse(to_world), take_boolean(properties, "flip_normals", false)};
}

Geometry read_geometry(Loader& loader, Properties& properties) {
    if (properties.type == "obj" || properties.type == "ply") return load_mesh(loader, properties);
    if (properties.type == "rectangle") return flat_mesh(properties, unit_rectangle());
    if (properties.type == "cube") return flat_mesh(properties, unit_cube());
    if (properties.type == "sphere") return read_sphere(properties);
    if (properties.type == "disk") return read_disk(properties);
    fail_plugin(*properties.node, kUnsupported,
                "\"obj\", \"ply\", \"rectangle\", \"cube\", \"sphere\" or \"disk\"");
}

MaterialId add_diffuse(Scene& scene, const std::string& id, float reflectance) {
    scene.bsdfs.push_back(Diffuse{{{reflectance, reflectance, reflectance}, {}}});
    scene.materials.push_back({id, BsdfId{static_cast<std::int32_t>(scene.bsdfs.size()) - 1}, {}});
    return {static_cast<std::int32_t>(scene.materials.size()) - 1};
}

MaterialId take_material(Loader& loader, Properties& properties, const std::string& shape_id,
                         bool emits) {
    const std::vector<const Property*> bsdfs = take_tag(properties, "bsdf");
    if (bsdfs.size() > 1)
        fail(bsdfs[1]->site->place, "the shape has a second bsdf, expected at most one");
    if (bsdfs.size() == 1) return load_material(loader, *bsdfs[0]->node, shape_id + ".bsdf");
    return add_diffuse(loader.result.scene, shape_id + ".bsdf", emits ? 0.0f : 0.5f);
}

void warn_without_uv(Loader& loader, const Properties& properties, const Shape& shape) {
    const Mesh* mesh = mesh_of(shape.geometry);
    const Scene& scene = loader.result.scene;
    if (mesh && mesh->uvs.empty() && !textures_of(scene, shape.material).empty())
        log_warning(loader, properties.node->place,
                    fmt::format("shape \"{}\" has a textured bsdf but no texture coordinates: the "
                                "barycentric ones are used",
                                properties.type));
}

}  // namespace

void load_shape(Loader& loader, const Node& node) {
    Scene& scene = loader.result.scene;
    Properties properties = open_properties(loader.document, node);
    Shape shape;
    const int number = loader.shapes++;
    shape.id =
        attribute(node, "id").empty() ? fmt::format("shape_{}", number) : attribute(node, "id");
    shape.geometry = read_geometry(loader, properties);

    const std::vector<const Property*> emitters = take_tag(properties, "emitter");
    if (emitters.size() > 1)
        fail(emitters[1]->site->place, "the shape has a second emitter, expected at most one");
    shape.material = take_material(loader, properties, shape.id, !emitters.empty());
    if (!emitters.empty()) {
        const ShapeId id{static_cast<std::int32_t>(scene.shapes.size())};
        const std::string emitter_id = attribute(*emitters[0]->node, "id");
        scene.emitter_ids.push_back(emitter_id.empty() ? shape.id : emitter_id);
        scene.emitters.push_back(load_area_emitter(loader, *emitters[0]->node, id));
        shape.emitter = EmitterId{static_cast<std::int32_t>(scene.emitters.size()) - 1};
    }
    warn_without_uv(loader, properties, shape);
    warn_unknown(properties, loader.result.warnings);
    scene.shapes.push_back(std::move(shape));
}

}  // namespace burnish::mitsuba
