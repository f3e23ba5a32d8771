// Light from an environment map, and drawing directions in proportion to it.
//
// The radiance is bilinear between texels whose centres are at u = (x + 1/2) / width (periodic) and
// v = y / (height - 1) (row 0 and the last row are the poles). The importance table has one cell
// between each four neighbouring texels, of weight mean luminance of the corners * solid angle of
// the cell; inside a cell directions are uniform in solid angle, so the density is one number per
// cell. Where the map is black everywhere, directions are uniform.
#pragma once

#include <array>
#include <cmath>

#include "burnish/core/alias_table.h"
#include "burnish/scene/emitter.h"

namespace burnish {

/// A row-major 3x3 matrix.
struct Rotation {
    std::array<float, 9> m{1, 0, 0, 0, 1, 0, 0, 0, 1};
};

inline Vec3f rotate(const Rotation& r, const Vec3f& v) {
    return {r.m[0] * v.x + r.m[1] * v.y + r.m[2] * v.z, r.m[3] * v.x + r.m[4] * v.y + r.m[5] * v.z,
            r.m[6] * v.x + r.m[7] * v.y + r.m[8] * v.z};
}

/// An emitter made ready for look-ups and sampling. The emitter must outlive it.
struct EnvironmentTable {
    const EnvironmentEmitter* emitter = nullptr;
    Rotation to_local, to_world;
    int columns = 0, rows = 0;   ///< cells
    AliasTable cells;            ///< [rows, columns]
    std::vector<float> density;  ///< [rows, columns]: 1 / sr of each direction in the cell
    std::vector<double>
        row_cosine;  ///< [rows + 1]: cosine of the polar angle where each row of cells begins
};

/// Throws std::domain_error where to_world has no inverse. A scale in to_world is ignored.
EnvironmentTable make_environment_table(const EnvironmentEmitter& emitter);

struct EnvironmentSample {
    Vec3f direction_world;  ///< unit, away from the scene
    float pdf = 0;          ///< solid angle
    Rgbf radiance;
};

/// u: four independent uniforms in [0, 1): the cell takes the first two, the place in it the
/// others.
EnvironmentSample sample_environment(const EnvironmentTable& table, const std::array<float, 4>& u);

/// Density of sample_environment; direction unit, away from the scene.
float pdf_environment(const EnvironmentTable& table, const Vec3f& direction_world);

/// Linear RGB seen along a unit direction.
Rgbf eval_environment(const EnvironmentTable& table, const Vec3f& direction_world);

/// Radiance and density together: they share their trigonometry.
EnvironmentSample lookup_environment(const EnvironmentTable& table, const Vec3f& direction_world);

/// The slow form of eval_environment, which prepares nothing.
Rgbf radiance(const EnvironmentEmitter& emitter, const Vec3f& direction_world);

}  // namespace burnish
