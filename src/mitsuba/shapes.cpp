// Shapes: obj, ply, serialized, rectangle, cube, sphere, disk, cylinder.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "burnish/error.h"
#include "core/frame.h"
#include "mitsuba/attributes.h"
#include "mitsuba/loader.h"
#include "mitsuba/mesh.h"
#include "mitsuba/obj.h"
#include "mitsuba/ply.h"
#include "mitsuba/serialized.h"
#include "mitsuba/transforms.h"
#include "scene/camera.h"

namespace burnish::mitsuba {

namespace {

constexpr const char* kUnsupportedShapes =
    "bsplinecurve deformable ellipsoids ellipsoidsmesh hair heightfield linearcurve sdfgrid";

[[noreturn]] void fail_no_inverse(const Properties& properties) {
    fail(properties.node->place,
         "\"to_world\" of the shape has no inverse, expected an invertible transform");
}

Transform take_to_world(Properties& properties) {
    const Transform to_world = take_transform(properties, "to_world").value_or(Transform{});
    const double determinant = determinant3(to_world);
    if (!std::isfinite(determinant) || determinant == 0) fail_no_inverse(properties);
    return to_world;
}

MeshOptions take_mesh_options(Properties& properties) {
    MeshOptions options{take_to_world(properties), take_boolean(properties, "face_normals", false),
                        take_boolean(properties, "flip_normals", false)};
    if (const Property* to_world = take(properties, "to_world"))
        options.to_local = read_skewed_inverse(*to_world->node);
    return options;
}

MeshFile read_mesh_file(const Loader& loader, const std::filesystem::path& file,
                        Properties& properties) {
    const int index = properties.type == "serialized"
                          ? take_integer(properties, "shape_index", 0, 0, 1 << 30)
                          : 0;
    const auto tell = [&](double bytes) { tell_reading(loader, file, bytes); };
    try {
        tell(0);
        if (properties.type == "obj") return read_obj_file(file);
        if (properties.type == "ply") return read_ply_file(file, {.before_mesh = tell});
        return read_serialized(file, static_cast<std::size_t>(index), tell);
    } catch (const InputError& error) {
        fail(properties.node->place, error.what());
    }
}

/// Says what an OBJ mesh lacks at some corners, and how many vertices of a mesh have the normal 0.
void warn_of_corners(Loader& loader, const Properties& properties, const MeshFile& file,
                     std::size_t zero_normals, bool face_normals) {
    for (const std::string& text : corner_texts(file, face_normals))
        log_warning(loader, properties.node->place, text);
    if (zero_normals > 0)
        log_warning(loader, properties.node->place, zero_normals_text(zero_normals));
}

Mesh load_mesh(Loader& loader, Properties& properties) {
    const std::string name = take_file_name(properties);
    MeshOptions options = take_mesh_options(properties);
    const bool flip_uvs = take_boolean(properties, "flip_tex_coords", properties.type == "obj");
    const std::filesystem::path path = resolve_file(loader.document, properties.node->place, name);
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(path, error);
    if (!error) count_again(loader, *properties.node, bytes);
    MeshFile file = read_mesh_file(loader, path, properties);
    const std::size_t zero_normals = options.face_normals ? 0 : fill_zero_normals(file.mesh);
    warn_of_corners(loader, properties, file, zero_normals, options.face_normals);
    if (flip_uvs)
        for (Vec2f& uv : file.mesh.uvs) uv.y = 1 - uv.y;
    loader.attributes = {path, {}, std::move(file.attributes)};
    return finish_mesh(std::move(file.mesh), options);
}

/// Rectangle and cube: flat faces, whose shading normals are the face normals.
Mesh flat_mesh(Properties& properties, Mesh mesh) {
    MeshOptions options = take_mesh_options(properties);
    options.face_normals = false;  // the normals decide the winding under a mirror
    mesh = finish_mesh(std::move(mesh), options);
    if (!options.to_local) mesh.normals.clear();
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

Cylinder read_cylinder(Properties& properties) {
    const Vec3<double> p0 = take_point(properties, "p0").value_or(Vec3<double>{}),
                       p1 = take_point(properties, "p1").value_or(Vec3<double>{0, 0, 1});
    const double radius = take_number(properties, "radius", 1), height = length(p1 - p0);
    if (!(radius > 0) || !(height > 0))
        fail(properties.node->place,
             fmt::format("the cylinder has the radius {} and the length {}, expected both above 0",
                         radius, height));
    const Vec3<double> z = (p1 - p0) * (1 / height);
    const FrameOf<double> frame = frame_from_normal(z);
    Transform along;
    for (int i = 0; i < 3; ++i)
        along(i, 0) = frame.s[i] * radius, along(i, 1) = frame.t[i] * radius,
                 along(i, 2) = z[i] * height, along(i, 3) = p0[i];
    Cylinder cylinder;
    cylinder.to_world = take_to_world(properties) * along;
    const Transform& m = cylinder.to_world;
    const double a = length(column_of(m, 0)), b = length(column_of(m, 1)),
                 c = length(column_of(m, 2));
    const auto skew = [&](int i, int j) { return std::abs(dot(column_of(m, i), column_of(m, j))); };
    constexpr double kTolerance = 1e-3;
    if (std::abs(a / b - 1) > kTolerance || skew(0, 1) > kTolerance * a * b ||
        skew(0, 2) > kTolerance * a * c || skew(1, 2) > kTolerance * b * c)
        fail(properties.node->place,
             "\"to_world\" of the cylinder shears, or scales its cross-section differently along "
             "two axes, expected a round one");
    cylinder.to_local = inverse(cylinder.to_world);
    cylinder.flip_normals = take_boolean(properties, "flip_normals", false);
    return cylinder;
}

Geometry read_geometry(Loader& loader, Properties& properties) {
    if (properties.type == "obj" || properties.type == "ply" || properties.type == "serialized")
        return load_mesh(loader, properties);
    if (properties.type == "cylinder") return read_cylinder(properties);
    if (properties.type == "rectangle") return flat_mesh(properties, unit_rectangle());
    if (properties.type == "cube") return flat_mesh(properties, unit_cube());
    if (properties.type == "sphere") return read_sphere(properties);
    if (properties.type == "disk") return read_disk(properties);
    fail_plugin(*properties.node, kUnsupportedShapes,
                "\"obj\", \"ply\", \"serialized\", \"rectangle\", \"cube\", \"sphere\", \"disk\", "
                "\"cylinder\", \"instance\", \"shapegroup\" or \"merge\"");
}

/// In world space, of a prototype in that of its group.
void require_geometry_reach(const Place& place, const Geometry& geometry) {
    if (const Mesh* mesh = mesh_of(geometry)) {
        for (const Vec3f& p : mesh->positions) require_reach(place, {p, p});
        return;
    }
    require_reach(place, burnish::box_of(geometry));
}

MaterialId add_diffuse(Scene& scene, const std::string& id, float reflectance) {
    scene.bsdfs.push_back(Diffuse{{{reflectance, reflectance, reflectance}, {}}});
    scene.materials.push_back({id, BsdfId{static_cast<std::int32_t>(scene.bsdfs.size()) - 1}, {}});
    return {static_cast<std::int32_t>(scene.materials.size()) - 1};
}

MaterialId take_material(Loader& loader, Properties& properties, const std::string& shape_id,
                         bool emits) {
    const Property* bsdf = take_only(properties, "bsdf");
    const std::string id = shape_id + ".bsdf";
    MaterialId material;
    const auto read = [&] { material = load_material(loader, *bsdf->node, id); };
    if (bsdf && read_or_leave_out(loader, "its shape is diffuse", read)) return material;
    const bool is_black = emits && !bsdf;
    return add_diffuse(loader.result.scene, id, is_black ? 0.0f : 0.5f);
}

/// Of the values of the bitmaps from one on.
std::size_t texture_bytes(const Scene& scene, std::size_t first) {
    std::size_t bytes = 0;
    for (std::size_t i = first; i < scene.textures.size(); ++i)
        if (const Bitmap* bitmap = bitmap_of(scene.textures[i]))
            bytes += bitmap->values.size() * sizeof(float);
    return bytes;
}

/// Materials and emitters that read mesh attributes are built anew for each shape.
void forget_attributes_of(Loader& loader, const Properties& properties) {
    for (const Property& property : properties.all)
        if (property.node->tag == "bsdf" || property.node->tag == "emitter")
            forget_attributes(loader, *property.node);
}

/// textures: of the material and the emitter.
void warn_without_uv(Loader& loader, const Properties& properties, const Shape& shape,
                     const std::vector<TextureId>& textures) {
    const Mesh* mesh = mesh_of(shape.geometry);
    if (mesh && mesh->uvs.empty() && mesh->lookup_uvs.empty() && !textures.empty())
        log_warning(loader, properties.node->place,
                    fmt::format("shape \"{}\" has a texture but no texture coordinates: the "
                                "barycentric ones are used",
                                properties.type));
}

/// Nothing here scatters between surfaces.
void refuse_media(Loader& loader, Properties& properties) {
    for (const Property* medium : take_tag(properties, "medium"))
        leave_out(loader,
                  Unsupported(sentence(medium->site->place,
                                       fmt::format("the participating medium \"{}\" of a shape is "
                                                   "not supported yet: expected surfaces only",
                                                   medium->name))),
                  "its shape stays");
}

/// The emitter of a shape, which is the next of the scene.
std::optional<AreaEmitter> take_emitter(Loader& loader, Properties& properties) {
    const Property* found = take_only(properties, "emitter");
    if (!found) return {};
    if (!loader.surfaces_read.insert(found->node).second)
        add_again(loader, *found->node, size_of(*found->node));
    std::optional<AreaEmitter> emitter;
    const ShapeId id{static_cast<std::int32_t>(loader.result.scene.shapes.size())};
    read_or_leave_out(loader, "its shape does not shine",
                      [&] { emitter = load_area_emitter(loader, *found->node, id); });
    return emitter;
}

/// Points of a light are drawn with the density 1 / area, and of a triangle also needs its normal,
/// by the square of its area, in single precision.
bool has_area(const Geometry& geometry) {
    constexpr double kMinTriangle = 1e-18;
    if (const Mesh* mesh = mesh_of(geometry))
        return std::any_of(mesh->triangles.begin(), mesh->triangles.end(), [&](const Triangle& t) {
            return triangle_area(*mesh, t) >= kMinTriangle;
        });
    return static_cast<float>(area_of(geometry)) >= std::numeric_limits<float>::min();
}

void require_area(const Properties& properties, const Geometry& geometry) {
    if (!has_area(geometry))
        fail(properties.node->place, "the shape emits and has no area, expected one that has some");
}

EmitterId add_emitter(Scene& scene, Properties& properties, const Shape& shape,
                      const AreaEmitter& emitter) {
    scene.emitter_ids.push_back(id_or(*take_only(properties, "emitter")->node, shape.id));
    scene.emitters.push_back(emitter);
    return EmitterId{static_cast<std::int32_t>(scene.emitters.size()) - 1};
}

}  // namespace

void require_reach(const Place& place, const Box& box) {
    constexpr double kMax = kMaxDistance;
    for (const Vec3f& p : {box.low, box.high}) {
        const double x = std::abs(p.x), y = std::abs(p.y), z = std::abs(p.z);
        if (x <= kMax && y <= kMax && z <= kMax) continue;
        fail(place,
             fmt::format("the shape reaches to {:.6g}, expected it within {:g} of the origin",
                         std::max({x, y, z}), kMax));
    }
}

Shape read_shape(Loader& loader, Properties& properties, bool emits) {
    Shape shape;
    ignore(properties, {"silhouette_sampling_weight"});  // only how Mitsuba samples it
    shape.id = id_or_made_up(loader, *properties.node, fmt::format("shape_{}", loader.shapes++));
    loader.attributes = {};
    begin_reading(loader, *properties.node);
    try {
        shape.geometry = read_geometry(loader, properties);
    } catch (const std::domain_error&) {
        fail_no_inverse(properties);
    }
    require_geometry_reach(properties.node->place, shape.geometry);
    if (const Mesh* mesh = mesh_of(shape.geometry)) {
        count_again(loader, *properties.node, bytes_of(*mesh));
        loader.kept += static_cast<double>(bytes_of(*mesh));
        if (!loader.attributes.attributes.empty()) loader.attributes.triangles = mesh->triangles;
    }
    refuse_media(loader, properties);
    forget_attributes_of(loader, properties);
    const std::size_t known = loader.result.scene.textures.size();
    shape.material = take_material(loader, properties, shape.id, emits);
    const std::optional<AreaEmitter> emitter =
        emits ? take_emitter(loader, properties) : std::nullopt;
    count_again(loader, *properties.node, texture_bytes(loader.result.scene, known));
    std::vector<TextureId> textures = textures_of(loader.result.scene, shape.material);
    if (emitter && emitter->texture) textures.push_back(emitter->texture);
    use_attributes(loader, properties, shape, textures);
    warn_without_uv(loader, properties, shape, textures);
    if (!emitter) return shape;
    require_area(properties, shape.geometry);
    shape.emitter = add_emitter(loader.result.scene, properties, shape, *emitter);
    return shape;
}

void load_shape(Loader& loader, const Node& node) {
    Properties properties = open_properties(loader.document, node);
    if (is_compound(properties.type)) return load_compound(loader, properties);
    const bool emits = !take_tag(properties, "emitter").empty();
    Shape shape = read_shape(loader, properties, emits);
    warn_unknown(properties, loader.result.warnings);
    loader.result.scene.shapes.push_back(std::move(shape));
}

}  // namespace burnish::mitsuba
