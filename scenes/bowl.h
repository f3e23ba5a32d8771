// The bowl's shape, shared by its mesh and its textures.
//
// A curve from the middle of the inside over the rim down to the foot is turned around the y axis.
// A place on it is (s, k): s in [0, 1) around one of kBowlRepeats repeats, k the knot coordinate.
// Texture coordinates are u along the curve and v around the axis, so that the tangent of the
// shading frame, along which an anisotropic lobe is wide, runs along the curve: across the grooves
// that a brush leaves on a lathe.
#pragma once

#include "image/image.h"
#include "scenes/turned.h"

namespace burnish::procedural {

inline constexpr int kBowlRepeats = 4;

/// Knot coordinates where one ornament ends and the next begins.
struct BowlBands {
    double rosette = 1.3, lattice = 4.0, flutes = 7.0, rim = 11.2, waist = 15.3, foot = 17.0;
};

CurveRows make_bowl_rows();  ///< how texture columns (u in [0, 1]) lie on the curve
Mesh make_bowl();            ///< with four rests in the rim; v in [0, kBowlRepeats]
Mesh make_ring_light();      ///< a torus around the y axis, of radii 0.5 and 0.06, facing outward

struct BowlTextures {
    Image anisotropic;  ///< [size, size, 1], 0.06 to 0.94
    Image base_color;   ///< [size, size, 3], linear
};
BowlTextures make_bowl_textures(int size, std::uint32_t seed);

/// Dark stone with pale veins, [size, size, 3], linear.
Image make_stone_texture(int size, std::uint32_t seed);

}  // namespace burnish::procedural
