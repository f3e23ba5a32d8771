// Light from an environment map, and drawing directions in proportion to it.
//
// The radiance is bilinear between texels whose centres are at u = (x + 1/2) / width (periodic) and
// v = y / (height - 1) (row 0 and the last row are the poles). The importance table has one cell
// between each four neighbouring texels, of weight mean luminance of the corners * solid angle of
// the cell; inside a cell directions are uniform in solid angle, so the density is one number per
// cell. Where the map is black everywhere, directions are uniform.
#pragma once

#include <array>

#include "core/alias_table.h"
#include "core/packet.h"
#include "scene/emitter.h"

namespace burnish {

/// A row-major 3x3 matrix.
struct Rotation {
    std::array<float, 9> m{1, 0, 0, 0, 1, 0, 0, 0, 1};
};

template <class T>
Vec3<T> rotate(const Rotation& r, const Vec3<T>& v) {
    const auto row = [&](std::size_t i) {
        return T(r.m[i]) * v.x + T(r.m[i + 1]) * v.y + T(r.m[i + 2]) * v.z;
    };
    return {row(0), row(3), row(6)};
}

/// An image of a sky made ready for look-ups and sampling.
struct SkyTable {
    SharedImage image;
    int columns = 0, rows = 0;  ///< cells
    AliasTable cells;           ///< [rows, columns]
    /// One texel, and the density (1 / sr) of each direction in the cell to its lower right: what a
    /// look-up reads lies together.
    struct Texel {
        float r = 0, g = 0, b = 0, density = 0;
    };
    std::vector<Texel> texels;  ///< [image height, columns]; without an emitter's scale
    /// Half-angle squares sin^2(theta / 2), cos^2(theta / 2) of the polar angle where a row of
    /// cells begins: both linear in cos(theta), and precise at both poles.
    struct RowStart {
        float sin2 = 0, cos2 = 0;
    };
    std::vector<RowStart> row_starts;  ///< [rows + 1]
};

/// An emitter made ready.
struct EnvironmentTable {
    std::shared_ptr<const SkyTable> sky;
    float scale = 1;  ///< of the radiance
    Rotation to_local, to_world;
};

/// Throws std::domain_error where to_world has no inverse. A scale in to_world is ignored. sky: a
/// table that is shared, if it is of the emitter's image; otherwise one is made.
EnvironmentTable make_environment_table(const EnvironmentEmitter& emitter,
                                        std::shared_ptr<const SkyTable> sky = {});

/// T: float, or Packet for sixteen samples.
template <class T>
struct EnvironmentSampleOf {
    Vec3<T> direction_world;  ///< unit, away from the scene
    T pdf{};                  ///< solid angle
    Rgb<T> radiance;
};
using EnvironmentSample = EnvironmentSampleOf<float>;

/// u: four independent uniforms in [0, 1): the cell takes the first two, the place in it the
/// others.
template <class T>
EnvironmentSampleOf<T> sample_environment(const EnvironmentTable& table, const std::array<T, 4>& u);

/// Linear RGB and the density of sample_environment along a unit direction, away from the scene.
template <class T>
EnvironmentSampleOf<T> lookup_environment(const EnvironmentTable& table,
                                          const Vec3<T>& direction_world);

/// Linear RGB seen along a unit direction; the slow form, which prepares nothing.
Rgbf radiance(const EnvironmentEmitter& emitter, const Vec3f& direction_world);

}  // namespace burnish
