#include "paths/traced_scene.h"

#include <algorithm>

#include "core/contract.h"
#include "core/variant.h"
#include "paths/bsdf_columns.h"

namespace burnish {

namespace {

/// Whether a BSDF reflects nothing whatever its textures hold: the shape of a lamp, often.
bool always_black(const Bsdf& bsdf) {
    const auto black = [](const ColorInput& c) { return !c.texture && is_black(c.constant); };
    return match(
        bsdf, [&](const Diffuse& b) { return black(b.reflectance); },
        [](const Principled&) { return false; },
        [&](const Conductor& b) { return black(b.reflectance); },
        [&](const RoughConductor& b) { return black(b.reflectance); },
        [&](const Plastic& b) { return black(b.colors[0]) && black(b.colors[1]); },
        [&](const RoughPlastic& b) { return black(b.colors[0]) && black(b.colors[1]); },
        [&](const Dielectric& b) { return black(b.colors[0]) && black(b.colors[1]); },
        [&](const RoughDielectric& b) { return black(b.colors[0]) && black(b.colors[1]); },
        [](const PrincipledThin&) { return false; });
}

/// Contract of a kind of BSDF: its inputs fit into the rows that are made for them.
void check_row(const Bsdf& bsdf) {
    const std::size_t colors = colors_of(bsdf).size();
    const bool is_principled = std::holds_alternative<Principled>(bsdf);
    BURNISH_REQUIRE(colors, >, 0u);  // see kMaxTexelsPerPath
    BURNISH_REQUIRE(kBsdfColor * colors + scalars_of(bsdf).size(), <=,
                    is_principled ? kBsdfInputs : kBsdfRowInputs);
}

BsdfOrder order_bsdfs(const Scene& scene) {
    for (const Bsdf& bsdf : scene.bsdfs) check_row(bsdf);
    BsdfOrder order;
    order.rank.assign(scene.bsdfs.size(), -1);
    std::int32_t next = 0;
    for (std::size_t kind = 0; kind < std::variant_size_v<Bsdf>; ++kind) {
        order.kind_begin[kind] = static_cast<std::size_t>(next);
        for (std::size_t i = 0; i < scene.bsdfs.size(); ++i)
            if (scene.bsdfs[i].index() == kind && !always_black(scene.bsdfs[i]))
                order.rank[i] = next++;
    }
    order.kind_begin.back() = static_cast<std::size_t>(next);
    return order;
}

std::vector<BsdfId> plain_bsdfs(const Scene& scene) {
    std::vector<BsdfId> plain;
    for (const Shape& shape : scene.shapes) {
        const Material& m = scene[shape.material];
        const bool depends = m.blend || (m.back && m.back != m.front);
        plain.push_back(depends ? BsdfId{} : m.front);
    }
    return plain;
}

std::vector<char> read_uvs(const Scene& scene) {
    std::vector<char> reads;
    for (const Bsdf& bsdf : scene.bsdfs) reads.push_back(!textures_of(bsdf).empty());
    for (const Material& m : scene.materials)
        for (const BsdfId id : {m.front, m.back})
            if (m.normals && id) reads[static_cast<std::size_t>(id.value)] = 1;
    return reads;
}

/// What the camera sees where emitters are hidden; none where it sees all.
std::optional<Accel> without_emitters(const Scene& scene, bool has_emitting) {
    if (!scene.hide_emitters || !has_emitting) return {};
    return Accel(scene, Shapes::kNotEmitting);
}

}  // namespace

TracedScene prepare(const Scene& scene, LightSelection selection) {
    check_references(scene);
    const bool has_emitting = std::any_of(scene.shapes.begin(), scene.shapes.end(),
                                          [](const Shape& s) { return bool(s.emitter); });
    TracedScene view;
    view.scene = &scene;
    view.geometry = std::make_shared<const SceneGeometry>(SceneGeometry{
        Accel(scene), Accel(scene, Shapes::kEmitting), without_emitters(scene, has_emitting),
        has_emitting, make_triangle_table(scene), order_bsdfs(scene), plain_bsdfs(scene),
        read_uvs(scene)});
    view.lights =
        std::make_shared<const Lights>(build_lights(scene, view.geometry->triangles, selection));
    return with_camera(view, make_camera_rays(scene.camera, scene.film), scene.film);
}

TracedScene with_camera(const TracedScene& view, const CameraRays& camera, const Film& film) {
    TracedScene other = view;
    other.film = film;
    other.camera = camera;
    return other;
}

TracedScene with_emitters(const TracedScene& view, std::vector<Emitter> emitters) {
    TracedScene other = view;
    const auto& environment = view.lights->environment;
    other.lights = std::make_shared<const Lights>(
        build_lights(*view.scene, view.geometry->triangles, view.lights->selector.selection,
                     std::make_shared<const std::vector<Emitter>>(std::move(emitters)),
                     environment ? environment->sky : nullptr));
    return other;
}

}  // namespace burnish
