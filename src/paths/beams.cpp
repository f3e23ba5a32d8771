#include "paths/beams.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/constants.h"
#include "paths/light_bounds.h"
#include "shading/texture_packet.h"

namespace burnish {

namespace {

constexpr float kDegrees = kPi / 180;

Vec3f column(const Transform& m, int j) {
    return {static_cast<float>(m(0, j)), static_cast<float>(m(1, j)), static_cast<float>(m(2, j))};
}

/// The way from a position to where a rigid transform has its origin, and the position in the
/// transform's axes as a direction from there.
struct ToOrigin {
    Vec3f direction_world, local;  ///< unit
    float distance = 0;
};

ToOrigin to_origin(const Transform& m, const Vec3f& position) {
    const Vec3f way = column(m, 3) - position;
    ToOrigin r;
    r.distance = length(way);
    if (!(r.distance > 0)) return r;
    r.direction_world = way * (1 / r.distance);
    const Vec3f back = -r.direction_world;
    r.local = {dot(back, column(m, 0)), dot(back, column(m, 1)), dot(back, column(m, 2))};
    return r;
}

Rgbf texture_at(const Scene& scene, TextureId texture, const Vec2f& uv) {
    if (!texture) return {1, 1, 1};
    return eval_texture(TextureTable{scene.textures, {}}, texture, uv);
}

LightSample delta_sample(const ToOrigin& way, const Rgbf& intensity) {
    return {way.direction_world, way.distance, intensity * (1 / (way.distance * way.distance)),
            1.0f, true};
}

/// 1 within the beam, 0 beyond the cutoff.
float falloff(const SpotEmitter& spot, float cosine) {
    if (cosine >= std::cos(spot.beam_width * kDegrees)) return 1;
    if (cosine <= std::cos(spot.cutoff * kDegrees)) return 0;
    const float angle = std::acos(std::clamp(cosine, -1.0f, 1.0f)) / kDegrees;
    return std::clamp((spot.cutoff - angle) / (spot.cutoff - spot.beam_width), 0.0f, 1.0f);
}

}  // namespace

LightSample sample_beam(const Scene& scene, const SpotEmitter& spot, const Vec3f& position) {
    const ToOrigin way = to_origin(spot.to_world, position);
    if (!(way.distance > 0)) return {};
    const float share = falloff(spot, way.local.z);
    if (!(share > 0)) return delta_sample(way, {});
    const float scale = 0.5f / (way.local.z * std::tan(spot.cutoff * kDegrees));
    const Rgbf texture =
        texture_at(scene, spot.texture, {0.5f + way.local.x * scale, 0.5f + way.local.y * scale});
    return delta_sample(way, spot.intensity * texture * share);
}

LightSample sample_beam(const Scene& scene, const ProjectorEmitter& projector,
                        const Vec3f& position) {
    const ToOrigin way = to_origin(projector.to_world, position);
    if (!(way.distance > 0)) return {};
    const float cosine = way.local.z;
    if (!(cosine > 0)) return delta_sample(way, {});
    const auto width = static_cast<float>(2 * std::tan(projector.fov_x * std::numbers::pi / 360));
    const auto height = width / static_cast<float>(projector.aspect);
    const Vec2f uv{0.5f - way.local.x / (cosine * width), 0.5f - way.local.y / (cosine * height)};
    if (!(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1)) return delta_sample(way, {});
    return delta_sample(way, projector.irradiance * texture_at(scene, projector.texture, uv) *
                                 (kPi / (cosine * cosine * cosine)));
}

LightSample sample_beam(const DirectionalEmitter& light) {
    return {-light.direction, std::numeric_limits<float>::infinity(), light.irradiance, 1.0f, true};
}

LightBounds beam_bounds(const Scene& scene, const SpotEmitter& spot) {
    constexpr float kNarrow = 80;  // degrees: further out the cosine to the axis may vanish
    const Vec3f position = column(spot.to_world, 3);
    return {{position, position},
            column(spot.to_world, 2),
            spot.cutoff < kNarrow ? 1.0f : -1.0f,
            luminance_of_magnitude(spot.intensity * mean_texture(scene, spot.texture))};
}

LightBounds beam_bounds(const Scene& scene, const ProjectorEmitter& projector) {
    const Vec3f position = column(projector.to_world, 3);
    return {{position, position},
            column(projector.to_world, 2),
            1,
            kPi * luminance_of_magnitude(projector.irradiance *
                                         mean_texture(scene, projector.texture))};
}

}  // namespace burnish
