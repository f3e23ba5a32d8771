#include "paths/seen.h"

namespace burnish {

namespace {

MaterialId shape_material(const Scene& scene, const RayLanes& rays, std::size_t i) {
    return scene.shapes[static_cast<std::size_t>(rays.shape[i])].material;
}

/// The material that the sample sees: of a blend one of the two.
ShownMaterial seen_material(const TraceInput& input, const RayLanes& rays, std::size_t i) {
    const Scene& scene = *input.scene->scene;
    const MaterialId id = shape_material(scene, rays, i);
    if (!scene[id].blend) return {id};
    const Vec2f uv = uv_at(scene, input.scene->geometry->triangles, hit_of(rays, i),
                           get(rays.rays.origin, i), get(rays.rays.direction, i));
    return shown_material(scene, *input.textures, id, layered_point(rays, i, uv),
                          {input.slots, input.mixture});
}

/// The BSDF of the side that the sample sees.
BsdfId seen_bsdf(const TraceInput& input, const Material& material, const RayLanes& rays,
                 std::size_t i) {
    if (!material.back || material.back == material.front) return material.front;
    const Surface s = surface_of(*input.scene, rays, i);
    const Vec3f direction = get(rays.rays.direction, i);
    Frame frame = s.shading;
    if (material.normals)
        frame = turned_frame(*material.normals, *input.scene->scene, *input.textures,
                             hit_of(rays, i), s, direction)
                    .shading;
    return dot(frame.n, direction) < 0 ? material.front : material.back;
}

}  // namespace

Surface surface_of(const TracedScene& traced, const RayLanes& rays, std::size_t i) {
    return surface_at(*traced.scene, traced.geometry->triangles, hit_of(rays, i),
                      get(rays.rays.origin, i), get(rays.rays.direction, i));
}

SeenBsdfs seen_bsdfs(const TraceInput& input, std::size_t count, const RayLanes& rays) {
    const Scene& scene = *input.scene->scene;
    const SceneGeometry& geometry = *input.scene->geometry;
    SeenBsdfs seen;
    for (std::size_t i = 0; i < count; ++i) {
        if (rays.shape[i] < 0) continue;
        const auto shape = static_cast<std::size_t>(rays.shape[i]);
        BsdfId id = geometry.plain_bsdf[shape];
        if (id) {
            seen.shown[i] = {scene.shapes[shape].material};
        } else {
            seen.shown[i] = seen_material(input, rays, i);
            id = seen_bsdf(input, scene[seen.shown[i].material], rays, i);
        }
        const bool black = geometry.bsdf_order.rank[static_cast<std::size_t>(id.value)] < 0;
        const bool chosen = input.choice == SurfaceChoice::kAll ||
                            is_unknown(input, id) == (input.choice == SurfaceChoice::kUnknown);
        if (!black && chosen) seen.bsdf[i] = id;
    }
    return seen;
}

}  // namespace burnish
