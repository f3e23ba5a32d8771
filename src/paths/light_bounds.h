// What the choice of an emitter knows of it.
#pragma once

#include <span>

#include "paths/light_tree.h"
#include "paths/triangles.h"
#include "scene/scene.h"

namespace burnish {

/// Box, cone of shading normals and intensity of an emitting shape. `triangles`: those of a mesh.
LightBounds area_light_bounds(const Geometry& geometry, std::span<const TriangleRecord> triangles,
                              const Rgbf& radiance, float area);
/// Positive where any channel carries light, of whatever sign; 0 where it is not finite, since such
/// samples are left out.
float luminance_of_magnitude(const Rgbf& c);

LightBounds point_light_bounds(const PointEmitter& point);

/// Luminous irradiance on a surface turned to all of the sky: pi times mean radiance.
float sky_irradiance(const EnvironmentEmitter& environment);
float sky_irradiance(const ConstantEmitter& constant);

/// Mean of the centres of the shapes that do not emit; the origin where there are none.
Vec3f middle_of_lit_shapes(const Scene& scene);

}  // namespace burnish
