#include "optimize/scene_inputs.h"

#include "optimize/input_hash.h"
#include "optimize/state_fields.h"

namespace burnish {

void fields(auto& archive, Is<Transform> auto& v) { archive(v.m); }
void fields(auto& archive, Is<ShapeId> auto& v) { archive(v.value); }
void fields(auto& archive, Is<AreaEmitter> auto& v) { archive(v.radiance, v.shape, v.texture); }
void fields(auto& archive, Is<EnvironmentEmitter> auto& v) {
    archive(*v.image, v.scale, v.to_world);
}
void fields(auto& archive, Is<ConstantEmitter> auto& v) { archive(v.radiance); }
void fields(auto& archive, Is<PointEmitter> auto& v) { archive(v.position, v.intensity); }
void fields(auto& archive, Is<SpotEmitter> auto& v) {
    archive(v.to_world, v.intensity, v.cutoff, v.beam_width, v.texture);
}
void fields(auto& archive, Is<DirectionalEmitter> auto& v) { archive(v.direction, v.irradiance); }
void fields(auto& archive, Is<ProjectorEmitter> auto& v) {
    archive(v.to_world, v.irradiance, v.texture, v.fov_x, v.aspect);
}

namespace {

void write_node(ArchiveWriter& archive, const mitsuba::Node& node) {
    archive(node.tag, node.attributes.size(), node.children.size());
    for (const auto& [name, value] : node.attributes) archive(name, value);
    for (const mitsuba::Node& child : node.children) write_node(archive, child);
}

void write_textures(ArchiveWriter& archive, const Scene& scene) {
    for (const Texture& texture : scene.textures)
        if (const Bitmap* b = bitmap_of(texture))
            archive(b->width, b->height, b->channels, b->codes, b->decode, b->values);
}

template <class T>
void write_array(ArchiveWriter& archive, const std::vector<T>& values) {
    archive(values.size());
    archive.raw(values.data(), values.size() * sizeof(T));
}

void write_meshes(ArchiveWriter& archive, const std::vector<Shape>& shapes) {
    for (const Shape& shape : shapes)
        if (const Mesh* mesh = mesh_of(shape.geometry)) {
            write_array(archive, mesh->positions), write_array(archive, mesh->normals);
            write_array(archive, mesh->uvs), write_array(archive, mesh->triangles);
            write_array(archive, mesh->lookup_uvs);
        }
}

void write_camera(ArchiveWriter& archive, const TracedScene& traced) {
    const CameraRays& c = traced.camera;
    const Film& f = traced.film;
    archive(c.eye, c.corner, c.across, c.down, c.near_clip, c.far_clip, c.kind, c.forward,
            c.aperture_radius, c.focus_distance);
    archive(c.bent.lens.lens.kind, c.bent.lens.lens.coefficients);
    archive.raw(&c.bent.corner, sizeof c.bent.corner);
    archive.raw(&c.bent.size, sizeof c.bent.size);
    archive.raw(&c.bent.axes, sizeof c.bent.axes);
    archive(f.width, f.height, f.crop_x, f.crop_y, f.crop_width, f.crop_height);
}

}  // namespace

std::vector<Input> inputs_of(const RendererData& renderer) {
    const LoadedScene& loaded = *renderer.loaded;
    const TracedScene& traced = renderer.traced;
    return {
        hashed_input("the scene's file",
                     [&](ArchiveWriter& a) { write_node(a, loaded.source.root); }),
        hashed_input("the scene's textures",
                     [&](ArchiveWriter& a) { write_textures(a, loaded.scene); }),
        hashed_input("the scene's shapes",
                     [&](ArchiveWriter& a) {
                         write_meshes(a, loaded.scene.shapes);
                         write_meshes(a, loaded.scene.prototypes);
                     }),
        hashed_input("the renderer's camera", [&](ArchiveWriter& a) { write_camera(a, traced); }),
        hashed_input("the renderer's light",
                     [&](ArchiveWriter& a) { a(*traced.lights->emitters); }),
        hashed_input("the light selection",
                     [&](ArchiveWriter& a) { a(traced.lights->selector.selection); })};
}

}  // namespace burnish
