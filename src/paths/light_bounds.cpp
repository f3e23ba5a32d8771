#include "paths/light_bounds.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/constants.h"
#include "core/variant.h"

namespace burnish {

namespace {

/// The axis and the cosine of a cone; (0, 0, 1) and -1 where it is all directions.
struct Cone {
    Vec3f axis{0, 0, 1};
    float cos_spread = -1;
};

/// Interpolated normals lie in the cone of the vertices' if it is convex.
Cone cone_of(std::span<const TriangleRecord> triangles) {
    Vec3f sum;
    for (const TriangleRecord& t : triangles)
        for (const Vec3f& n : t.normal)
            if (std::isfinite(dot(n, n))) sum += n;
    Cone cone{normalize(sum), 1};
    if (!std::isfinite(dot(cone.axis, cone.axis))) return {};
    for (const TriangleRecord& t : triangles)
        for (const Vec3f& n : t.normal)
            cone.cos_spread = std::min(cone.cos_spread, dot(n, cone.axis));
    return cone.cos_spread > 0 ? cone : Cone{};
}

}  // namespace

float luminance_of_magnitude(const Rgbf& c) {
    const float y = luminance(Rgbf{std::abs(c.x), std::abs(c.y), std::abs(c.z)});
    return std::isfinite(y) ? y : 0;
}

LightBounds area_light_bounds(const Geometry& geometry, std::span<const TriangleRecord> triangles,
                              const Rgbf& radiance, float area) {
    const Cone cone = match(
        geometry, [&](const Mesh&) { return cone_of(triangles); },
        [](const Sphere&) { return Cone{}; },
        [](const Disk& disk) {
            const Vec3f n = transform_normal(disk.to_local, {0, 0, 1});
            return Cone{disk.flip_normals ? -n : n, 1};
        },
        [](const Cylinder&) { return Cone{}; }, [](const Instance&) { return Cone{}; });
    return {box_of(geometry), cone.axis, cone.cos_spread,
            luminance_of_magnitude(radiance) * area * mean_cosine(cone.cos_spread)};
}

LightBounds point_light_bounds(const PointEmitter& point) {
    return {
        {point.position, point.position}, {0, 0, 1}, -1, luminance_of_magnitude(point.intensity)};
}

float sky_irradiance(const EnvironmentEmitter& environment) {
    const Image& image = *environment.image;
    double sum = 0, weights = 0;
    for (int y = 0; y < image.height; ++y) {
        const double weight =
            image.height > 1 ? std::sin(std::numbers::pi * y / (image.height - 1)) + 1e-6 : 1;
        for (int x = 0; x < image.width; ++x) {
            const float* texel = &image.values[3 * (static_cast<std::size_t>(y) *
                                                        static_cast<std::size_t>(image.width) +
                                                    static_cast<std::size_t>(x))];
            sum += weight *
                   static_cast<double>(luminance_of_magnitude({texel[0], texel[1], texel[2]}));
        }
        weights += weight * image.width;
    }
    return kPi * std::abs(environment.scale) * static_cast<float>(sum / weights);
}

float sky_irradiance(const ConstantEmitter& constant) {
    return kPi * luminance_of_magnitude(constant.radiance);
}

Vec3f middle_of_lit_shapes(const Scene& scene) {
    Vec3f sum;
    float count = 0;
    for (const Shape& shape : scene.shapes) {
        if (shape.emitter) continue;
        sum += box_of(scene, shape).center(), ++count;
    }
    return count > 0 ? sum * (1 / count) : sum;
}

}  // namespace burnish
