#include "paths/layers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/random.h"

namespace burnish {

namespace {

/// Uniform in [0, 1): a hash of the ray. level: of a blend within blends.
float number_of(const LayeredPoint& p, std::uint32_t level) {
    const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
    const std::array<std::uint32_t, 4> direction{bits(p.direction.x), bits(p.direction.y),
                                                 bits(p.direction.z), level};
    const auto first = philox4x32(direction, {bits(p.origin.x), bits(p.origin.y)});
    return to_unit_float(philox4x32(first, {bits(p.origin.z), level})[0]);
}

/// The least probability of a part whose weight is an unknown.
constexpr float kMinChance = 0.05f;

/// A blend's weight at a point, and the probability of its second material.
struct DrawnWeight {
    float share = 0, chance = 0;
    bool is_unknown = false;
};

DrawnWeight drawn_weight(const TextureTable& textures, const ScalarInput& weight, const Vec2f& uv,
                         const UnknownWeights& unknowns) {
    const auto texture = static_cast<std::size_t>(weight.texture.value);
    const bool is_unknown =
        weight.texture && !unknowns.slots.empty() && unknowns.slots[texture] >= 0;
    if (is_unknown && !unknowns.mixture.empty()) return {unknowns.mixture[0][texture], 0.5f, true};
    const float share = eval_scalar(textures, weight, uv);
    if (is_unknown) return {share, std::clamp(share, kMinChance, 1 - kMinChance), true};
    if (share >= 0 && share <= 1) return {share, share};
    const double w = share, sizes = std::abs(w) + std::abs(1 - w);
    return {share, static_cast<float>(std::abs(w) / sizes)};
}

/// A normal in the shading frame, of any length, and what the tangent there follows.
struct MappedNormal {
    Vec3f normal, tangent;
};

/// Heights h move the surface along its normal n: p' = p + h n, where n varies little.
MappedNormal bumped_normal(const Vec2f& gradient, const Tangents& tangents,
                           const Surface& surface) {
    const Vec3f& n = surface.shading.n;
    const auto bumped = [&](const Vec3f& tangent, float slope) {
        return tangent + n * (slope - dot(n, tangent));
    };
    const Vec3f normal =
        cross(bumped(tangents.dp_du, gradient.x), bumped(tangents.dp_dv, gradient.y));
    const float side = dot(surface.geometric_normal, normal) < 0 ? -1.0f : 1.0f;
    // The tangent is the world's, though the normal is local: so it is in Mitsuba.
    return {to_local(surface.shading, normal * side), tangents.dp_du};
}

MappedNormal mapped_normal(const NormalMap& map, const Scene& scene, const TextureTable& textures,
                           const Hit& hit, const Surface& surface) {
    if (map.height_scale)
        return bumped_normal(scalar_gradient(textures, map.texture, surface.uv) * *map.height_scale,
                             tangents_at(scene, hit, surface.position), surface);
    const Rgbf color = eval_texture(textures, map.texture, surface.uv);
    return {{2 * color.x - 1, 2 * color.y - 1, 2 * color.z - 1}, {1, 0, 0}};
}

}  // namespace

ShownMaterial shown_material(const Scene& scene, const TextureTable& textures, MaterialId material,
                             const LayeredPoint& point, const UnknownWeights& unknowns) {
    ShownMaterial shown{material};
    for (std::uint32_t level = 0; scene[shown.material].blend; ++level) {
        const MaterialBlend& blend = *scene[shown.material].blend;
        const DrawnWeight w = drawn_weight(textures, blend.weight, point.uv, unknowns);
        const bool second = number_of(point, level) < w.chance;
        shown.material = second ? blend.second : blend.first;
        const float share = second ? w.share : 1 - w.share;
        const float chance = second ? w.chance : 1 - w.chance;
        if (w.is_unknown)
            shown.share *= share, shown.chance *= chance;
        else if (share != chance)
            shown.chance *= chance / share;
    }
    return shown;
}

TurnedFrame turned_frame(const NormalMap& map, const Scene& scene, const TextureTable& textures,
                         const Hit& hit, const Surface& surface, const Vec3f& direction) {
    Frame seen = surface.shading;
    if (map.mirrored && dot(seen.n, direction) > 0) seen.n = -seen.n;
    const MappedNormal mapped = mapped_normal(map, scene, textures, hit, surface);
    const Vec3f wi = to_local(seen, -direction);
    Vec3f n = mapped.normal;
    if (map.flip_invalid && wi.z * dot(wi, n) <= 0) n = {-n.x, -n.y, n.z};
    const float squared = length_squared(n);
    n = squared > 0 ? n * (1 / std::sqrt(squared)) : Vec3f{0, 0, 1};
    Vec3f s = mapped.tangent - n * dot(n, mapped.tangent);
    const float s_squared = length_squared(s);
    s = s_squared > 0 ? s * (1 / std::sqrt(s_squared)) : Vec3f{0, 1, 0};
    return {{to_world(seen, s), to_world(seen, cross(n, s)), to_world(seen, n)}, seen.n};
}

float share_of_light(const NormalMap& map, const Vec3f& old_normal, const Vec3f& new_normal,
                     const Vec3f& direction) {
    const float old_cosine = dot(direction, old_normal);
    if (!(old_cosine * dot(direction, new_normal) > 0)) return 0;
    if (!map.shadowing) return 1;
    const auto tan_squared = [](float cosine) {
        return std::max(0.0f, 1 - cosine * cosine) / (cosine * cosine);
    };
    const float bend = std::min(0.125f * tan_squared(dot(old_normal, new_normal)), 1.0f);
    return 2 / (1 + std::sqrt(1 + bend * tan_squared(old_cosine)));
}

}  // namespace burnish
