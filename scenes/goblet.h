// The goblet's shape, shared by its meshes and its textures.
//
// The outer wall is a curve (r, y) from the lip down to the foot's edge, turned around the y axis:
// a Catmull-Rom spline through knots, so that a place on it is named by its *knot coordinate* k in
// [0, kGobletKnots - 1]. Texture rows are spread along it with more rows where the wall is wider.
// Around the axis the texture repeats kGobletRepeats times: from any side every texel is seen
// somewhere near the middle.
#pragma once

#include <cstdint>

#include "image/image.h"
#include "scenes/scene_files.h"
#include "scenes/turned.h"

namespace burnish::procedural {

inline constexpr int kGobletRepeats = 3;
inline constexpr int kGobletKnots = 23;

/// Knot coordinates where one ornament ends and the next begins.
struct GobletBands {
    float rim = 0.9f, frieze = 2.0f, belly = 4.4f, gadroons = 7.6f, neck = 10.0f, knop = 14.0f,
          stem = 17.0f, foot = 20.0f;
};

/// How texture rows (v in [0, 1], lip to foot) lie on the wall.
CurveRows make_goblet_rows();

Mesh make_goblet_wall();    ///< lip to foot, with relief; u in [0, kGobletRepeats]
Mesh make_goblet_inside();  ///< of the bowl
Mesh make_table_top();      ///< a round board at y = 0; uv spans the square around it
Mesh make_lantern();        ///< a drop of radius 1 around the origin

/// What the goblet is covered with, texel by texel.
struct GobletTextures {
    Image roughness;   ///< [size, size, 1], 0.1 to 0.8
    Image base_color;  ///< [size, size, 3], linear
};
GobletTextures make_goblet_textures(int size, std::uint32_t seed);

/// A dark inlaid table top, [size, size, 3], linear; the disc inscribed into the square is seen.
Image make_table_texture(int size, std::uint32_t seed);

/// An evening sky above, distant lamps below the horizon, [height, 2 height, 3], linear radiance.
Image make_evening_sky(int height, std::uint32_t seed);

}  // namespace burnish::procedural
