#include "scene/scene.h"

#include <algorithm>

#include "core/contract.h"

namespace burnish {

namespace {

template <class Tag, class T>
void check_id(Id<Tag> id, const std::vector<T>& array) {
    BURNISH_REQUIRE(id.value, >=, 0);
    BURNISH_REQUIRE(static_cast<std::size_t>(id.value), <, array.size());
}

template <class Tag, class T>
void check_optional_id(Id<Tag> id, const std::vector<T>& array) {
    if (id) check_id(id, array);
}

}  // namespace

void check_references(const Scene& scene) {
    for (const Bsdf& bsdf : scene.bsdfs)
        for (const TextureId id : textures_of(bsdf)) check_id(id, scene.textures);
    for (const auto& shares : scene.shares)
        for (const BlendShare& share : shares) check_id(share.weight, scene.textures);
    if (!scene.shares.empty()) BURNISH_REQUIRE(scene.shares.size(), ==, scene.bsdfs.size());
    for (const Material& material : scene.materials) {
        check_id(material.front, scene.bsdfs);
        check_optional_id(material.back, scene.bsdfs);
        if (material.normals) check_id(material.normals->texture, scene.textures);
        if (!material.blend) continue;
        check_optional_id(material.blend->weight.texture, scene.textures);
        for (const MaterialId id : {material.blend->first, material.blend->second})
            check_id(id, scene.materials);
    }
    for (const Shape& shape : scene.prototypes) {
        check_id(shape.material, scene.materials);
        BURNISH_REQUIRE(bool(shape.emitter), ==, false);
        BURNISH_REQUIRE(std::holds_alternative<Instance>(shape.geometry), ==, false);
    }
    for (const Shape& shape : scene.shapes) {
        check_id(shape.material, scene.materials);
        if (const auto* instance = std::get_if<Instance>(&shape.geometry)) {
            BURNISH_REQUIRE(instance->prototype, <, scene.prototypes.size());
            BURNISH_REQUIRE(bool(shape.emitter), ==, false);
        }
        check_optional_id(shape.emitter, scene.emitters);
        if (shape.emitter)  // only area lights shine from shapes
            BURNISH_REQUIRE(std::holds_alternative<AreaEmitter>(scene[shape.emitter]), ==, true);
    }
    for (const Emitter& emitter : scene.emitters)
        if (const auto* area = std::get_if<AreaEmitter>(&emitter))
            check_id(area->shape, scene.shapes);
    for (const Emitter& emitter : scene.emitters)
        check_optional_id(texture_of(emitter), scene.textures);
    for (const Parameter& parameter : scene.parameters) {
        check_id(parameter.texture, scene.textures);
        BURNISH_REQUIRE(bitmap_of(scene[parameter.texture]), !=, nullptr);
    }
}

DeltaLobes delta_lobes(const Scene& scene, BsdfId bsdf) {
    return std::visit([](const auto& b) { return delta_lobes(b); }, scene[bsdf]);
}

namespace {

/// Calls body(material) for a material and all that it blends.
void for_materials(const Scene& scene, MaterialId id, const auto& body) {
    const Material& material = scene[id];
    body(material);
    if (!material.blend) return;
    for_materials(scene, material.blend->first, body);
    for_materials(scene, material.blend->second, body);
}

}  // namespace

bool is_in(const Scene& scene, MaterialId inner, MaterialId material) {
    bool found = false;
    for_materials(scene, material, [&](const Material& m) { found |= &m == &scene[inner]; });
    return found;
}

std::vector<BsdfId> bsdfs_of(const Scene& scene, MaterialId material) {
    std::vector<BsdfId> all;
    for_materials(scene, material, [&](const Material& m) {
        for (const BsdfId id : {m.front, m.back})
            if (id && std::find(all.begin(), all.end(), id) == all.end()) all.push_back(id);
    });
    return all;
}

bool has_layers(const Scene& scene) {
    return std::any_of(scene.materials.begin(), scene.materials.end(),
                       [](const Material& m) { return m.normals || m.blend; });
}

const EnvironmentEmitter* environment_map(const Scene& scene) {
    for (const Emitter& emitter : scene.emitters)
        if (const auto* map = std::get_if<EnvironmentEmitter>(&emitter)) return map;
    return nullptr;
}

const Mesh* shown_mesh(const Scene& scene, const Shape& shape) {
    const auto* instance = std::get_if<Instance>(&shape.geometry);
    return mesh_of(instance ? scene.prototypes[instance->prototype].geometry : shape.geometry);
}

Box box_of(const Scene& scene, const Shape& shape) {
    const auto* instance = std::get_if<Instance>(&shape.geometry);
    if (!instance) return box_of(shape.geometry);
    return transform_box(instance->to_world,
                         box_of(scene.prototypes[instance->prototype].geometry));
}

std::vector<TextureId> textures_of(const Scene& scene, BsdfId bsdf) {
    std::vector<TextureId> textures = textures_of(scene[bsdf]);
    for (const BlendShare& share : shares_of(scene, bsdf)) textures.push_back(share.weight);
    return textures;
}

bool reads(const Scene& scene, BsdfId bsdf, TextureId texture) {
    const auto all = textures_of(scene, bsdf);
    return std::find(all.begin(), all.end(), texture) != all.end();
}

bool turns_normals(const Scene& scene, TextureId texture) {
    return std::ranges::any_of(scene.materials, [&](const Material& m) {
        return m.normals && m.normals->texture == texture;
    });
}

bool weighs_parts(const Scene& scene, TextureId texture) {
    return std::ranges::any_of(scene.materials, [&](const Material& m) {
        return m.blend && m.blend->weight.texture == texture;
    });
}

bool is_of_emitter(const Scene& scene, TextureId texture) {
    return std::ranges::any_of(scene.emitters,
                               [&](const Emitter& e) { return texture_of(e) == texture; });
}

Rgbf mean_texture(const Scene& scene, TextureId texture) {
    return texture ? mean_magnitude(scene[texture]) : Rgbf{1, 1, 1};
}

Rgbf mean_radiance(const Scene& scene, const AreaEmitter& area) {
    return area.radiance * mean_texture(scene, area.texture);
}

bool draws_paths(const Scene& scene, TextureId texture) {
    const auto samples = [&](const Bsdf& bsdf) {
        const int scalars = static_cast<int>(first_scalar(bsdf)),
                  end = scalars + static_cast<int>(scalars_of(bsdf).size());
        for (int place = 0; place < end; place += place < scalars ? 3 : 1)
            if (texture_at(bsdf, place) == texture && is_sampled_by(bsdf, place)) return true;
        return false;
    };
    return std::ranges::any_of(scene.bsdfs, samples) || weighs_parts(scene, texture) ||
           turns_normals(scene, texture) || is_of_emitter(scene, texture);
}

std::vector<TextureId> textures_of(const Scene& scene, MaterialId material) {
    std::vector<TextureId> textures;
    if (!material) return textures;
    const auto add = [&](TextureId t) {
        if (t && std::find(textures.begin(), textures.end(), t) == textures.end())
            textures.push_back(t);
    };
    for (const BsdfId id : bsdfs_of(scene, material))
        for (const TextureId t : textures_of(scene[id])) add(t);
    for_materials(scene, material, [&](const Material& m) {
        if (m.normals) add(m.normals->texture);
        if (m.blend) add(m.blend->weight.texture);
    });
    return textures;
}

}  // namespace burnish
