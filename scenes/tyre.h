// The tyre's shape, shared by its mesh and its textures.
//
// The tyre is turned around the y axis; its profile runs from the bead of the upper side over the
// tread to the bead of the lower side and mirrors itself at the middle of the tread. A place on it
// is (s, k): s in [0, 1) around one of kTyreRepeats repeats, k in [0, kTyreMiddle] the knot
// coordinate from a bead to the middle. Both halves show the same texture, so that every texel is
// seen on the near side wall or on the tread.
#pragma once

#include "image/image.h"
#include "scenes/turned.h"

namespace burnish::procedural {

inline constexpr int kTyreRepeats = 3;
inline constexpr double kTyreMiddle = 11.5;

/// Knot coordinates where one ornament ends and the next begins.
struct TyreBands {
    double rib = 2.9, letters = 3.2, letters_end = 6.1, serration = 6.5, shoulder = 7.6,
           tread = 8.5, groove = 9.8;
};

/// How texture rows (v in [0, 1], bead to middle) lie on a half.
struct TyreRows {
    CurveRows whole;
};
TyreRows make_tyre_rows();
double tyre_knot(const TyreRows& rows, double v);

double tyre_letters(double s, double k);  ///< raised letters: 1 on them, 0 beside
double tyre_grooves(double s, double k);  ///< of the tread: 1 at the bottom, 0 on the blocks

Mesh make_tyre();   ///< radius 1, with relief; u in [0, kTyreRepeats]
Mesh make_wheel();  ///< five spokes; faces up

struct TyreTextures {
    Image roughness;   ///< [size, size, 1], 0.07 to 0.93
    Image base_color;  ///< [size, size, 3], linear
};
TyreTextures make_tyre_textures(int size, std::uint32_t seed);

/// Concrete with joints and a painted line, [size, size, 3], linear.
Image make_workshop_texture(int size, double floor_end, std::uint32_t seed);

/// An overcast sky with windows of light, dim, [height, 2 height, 3], linear radiance.
Image make_dim_sky(int height, std::uint32_t seed);

}  // namespace burnish::procedural
