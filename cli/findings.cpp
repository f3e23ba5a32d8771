#include "cli/findings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/variant.h"
#include "scene/value_range.h"
#include "shading/texture.h"

namespace burnish {

namespace {

struct Strength {
    Rgbf low, high;
};

Strength strength_of(const EnvironmentEmitter& e) {
    Strength s{};
    for (std::size_t i = 0; i < e.image->values.size(); ++i) {
        const float v = e.image->values[i];
        float &low = s.low[static_cast<int>(i % 3)], &high = s.high[static_cast<int>(i % 3)];
        low = i < 3 ? v : std::min(low, v), high = i < 3 ? v : std::max(high, v);
    }
    return {s.low * e.scale, s.high * e.scale};
}

/// Of a textured one the mean stands for all.
Strength times_texture(const Scene& scene, const Rgbf& strength, TextureId texture) {
    const Rgbf mean = strength * mean_texture(scene, texture);
    return {mean, mean};
}

Strength strength_of(const Scene& scene, const Emitter& emitter) {
    return match(
        emitter, [&](const AreaEmitter& e) { return times_texture(scene, e.radiance, e.texture); },
        [](const PointEmitter& e) {
            return Strength{e.intensity, e.intensity};
        },
        [](const ConstantEmitter& e) {
            return Strength{e.radiance, e.radiance};
        },
        [](const EnvironmentEmitter& e) { return strength_of(e); },
        [&](const SpotEmitter& e) { return times_texture(scene, e.intensity, e.texture); },
        [](const DirectionalEmitter& e) {
            return Strength{e.irradiance, e.irradiance};
        },
        [&](const ProjectorEmitter& e) { return times_texture(scene, e.irradiance, e.texture); });
}

void check_mesh(const Shape& shape, const Mesh& mesh, Findings& findings) {
    const auto not_finite = std::count_if(mesh.positions.begin(), mesh.positions.end(),
                                          [](const Vec3f& p) { return !is_finite(p); });
    const auto flat =
        std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
            const Vec3f& p = mesh.positions[t.vertex[0]];
            const Vec3f n = cross(mesh.positions[t.vertex[1]] - p, mesh.positions[t.vertex[2]] - p);
            return is_finite(n) && length_squared(n) == 0;
        });
    const auto no_normal =
        std::count_if(mesh.normals.begin(), mesh.normals.end(),
                      [](const Vec3f& n) { return !(std::fabs(length(n) - 1) < 0.1f); });
    const auto add = [&](auto count, const char* what) {
        if (count > 0) findings.push_back(fmt::format("shape '{}': {} {}", shape.id, count, what));
    };
    add(not_finite, "vertices are not finite");
    add(flat, "triangles have no area");
    add(no_normal, "vertex normals have no direction");
}

bool outside(const Bitmap& bitmap, const Vec2f& uv) {
    constexpr float kSlack = 1e-3f;  // rounding in the files
    const Vec2f p = transform_uv(bitmap.to_uv, uv);
    return !(p.x >= -kSlack && p.x <= 1 + kSlack && p.y >= -kSlack && p.y <= 1 + kSlack);
}

void check_coordinates(const Scene& scene, const Shape& shape, const Mesh& mesh, TextureId id,
                       Findings& findings) {
    const Bitmap* bitmap = bitmap_of(scene[id]);
    if (!bitmap || bitmap->wrap != TextureWrap::kClamp) return;
    const auto count = std::count_if(mesh.uvs.begin(), mesh.uvs.end(),
                                     [&](const Vec2f& uv) { return outside(*bitmap, uv); });
    if (count > 0)
        findings.push_back(
            fmt::format("shape '{}': {} of {} texture coordinates lie outside of "
                        "the clamped texture '{}'",
                        shape.id, count, mesh.uvs.size(), bitmap->file));
}

}  // namespace

std::vector<MaterialId> shown_parts(const Scene& scene, MaterialId material) {
    const auto& blend = scene[material].blend;
    if (!blend) return {material};
    std::vector<MaterialId> parts;
    const auto add = [&](MaterialId part) {
        for (const MaterialId inner : shown_parts(scene, part)) parts.push_back(inner);
    };
    const ScalarInput& weight = blend->weight;
    if (weight.texture || weight.constant < 1) add(blend->first);
    if (weight.texture || weight.constant > 0) add(blend->second);
    return parts;
}

bool has_parameter(const Scene& scene, MaterialId material) {
    const std::vector<TextureId> textures = textures_of(scene, material);
    return std::ranges::any_of(scene.parameters, [&](const Parameter& p) {
        return std::ranges::count(textures, p.texture) > 0;
    });
}

bool has_black_back(const Scene& scene, MaterialId material) {
    return std::ranges::none_of(shown_parts(scene, material), [&](MaterialId part) {
        return scene[part].back || transmits(scene[scene[part].front]);
    });
}

std::string label_of_emitter(const Scene& scene, std::size_t i) {
    const auto numbered = [&] { return fmt::format("emitter {}", i + 1); };
    return match(
        scene.emitters[i],
        [&](const AreaEmitter& e) {
            return fmt::format("the area light of shape '{}'", scene[e.shape].id);
        },
        [](const EnvironmentEmitter&) { return std::string("the environment image"); },
        [&](const ConstantEmitter&) { return numbered(); },
        [&](const PointEmitter&) { return numbered(); },
        [&](const SpotEmitter&) { return numbered(); },
        [&](const DirectionalEmitter&) { return numbered(); },
        [&](const ProjectorEmitter&) { return numbered(); });
}

void check_lights(const Scene& scene, Findings& findings) {
    if (scene.emitters.empty()) findings.push_back("there is no light: the picture is black");
    for (std::size_t i = 0; i < scene.emitters.size(); ++i) {
        const Strength s = strength_of(scene, scene.emitters[i]);
        if (!(std::min({s.low.x, s.low.y, s.low.z}) >= 0))
            findings.push_back(label_of_emitter(scene, i) + " holds negative light");
        else if (!(max_component(s.high) > 0))
            findings.push_back(label_of_emitter(scene, i) + " is black");
    }
}

void check_meshes(const Scene& scene, Findings& findings) {
    for (const Shape& shape : scene.shapes)
        if (const Mesh* mesh = mesh_of(shape.geometry)) check_mesh(shape, *mesh, findings);
    for (const Shape& shape : scene.prototypes)
        if (const Mesh* mesh = mesh_of(shape.geometry)) check_mesh(shape, *mesh, findings);
}

void check_texture_coordinates(const Scene& scene, Findings& findings) {
    for (const Shape& shape : scene.shapes) {
        const Mesh* mesh = mesh_of(shape.geometry);
        if (!mesh || !mesh->lookup_uvs.empty()) continue;
        const std::vector<TextureId> textures = textures_of(scene, shape.material);
        if (mesh->uvs.empty() && !textures.empty())
            findings.push_back(
                fmt::format("shape '{}' is textured but has no texture coordinates: "
                            "every triangle shows the whole texture",
                            shape.id));
        for (const TextureId id : textures) check_coordinates(scene, shape, *mesh, id, findings);
    }
}

void check_textures(const Scene& scene, Findings& findings) {
    for (const Parameter& p : scene.parameters) {
        const Image texels = linear_image(std::get<Bitmap>(scene[p.texture]));
        const float max = largest_value(scene, p.texture);
        const auto count = std::count_if(texels.values.begin(), texels.values.end(),
                                         [&](float v) { return !(v >= 0 && v <= max); });
        if (count > 0)
            findings.push_back(fmt::format("{}: {} of {} values lie outside of [0, {}]", p.name,
                                           count, texels.values.size(), max));
    }
}

void check_materials(const Scene& scene, Findings& findings) {
    // By their BSDFs: a material inside another one shares its own.
    std::vector<char> used(scene.bsdfs.size(), 0);
    const auto use = [&](const std::vector<Shape>& shapes) {
        for (const Shape& shape : shapes)
            for (const BsdfId id : bsdfs_of(scene, shape.material))
                used[static_cast<std::size_t>(id.value)] = 1;
    };
    use(scene.shapes), use(scene.prototypes);
    std::vector<std::string> unused;
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const auto bsdfs = bsdfs_of(scene, {static_cast<std::int32_t>(i)});
        if (std::ranges::none_of(bsdfs, [&](BsdfId id) { return used[id.value]; }))
            unused.push_back(scene.materials[i].id);
    }
    if (!unused.empty())
        findings.push_back(fmt::format("no shape has the material{} {}",
                                       unused.size() == 1 ? "" : "s", fmt::join(unused, ", ")));
}

}  // namespace burnish
