#include "paths/traced_scene.h"

#include <algorithm>

#include "core/variant.h"

namespace burnish {

namespace {

/// Whether a BSDF reflects nothing whatever its textures hold: the shape of a lamp, often.
bool always_black(const Bsdf& bsdf) {
    return match(
        bsdf,
        [](const Diffuse& b) { return !b.reflectance.texture && is_black(b.reflectance.constant); },
        [](const Principled&) { return false; });
}

BsdfOrder order_bsdfs(const Scene& scene) {
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

}  // namespace

TracedScene prepare(const Scene& scene, LightSelection selection) {
    check_references(scene);
    auto triangles = std::make_unique<const TriangleTable>(make_triangle_table(scene));
    Lights lights = build_lights(scene, *triangles, selection);
    const bool has_emitting = std::any_of(scene.shapes.begin(), scene.shapes.end(),
                                          [](const Shape& s) { return bool(s.emitter); });
    return {&scene,
            Accel(scene),
            Accel(scene, Shapes::kEmitting),
            has_emitting,
            std::move(triangles),
            std::move(lights),
            make_camera_rays(scene.camera, scene.film),
            order_bsdfs(scene)};
}

}  // namespace burnish
