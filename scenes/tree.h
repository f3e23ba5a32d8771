// The decorated tree: tiers of boughs around the y axis, and what hangs on them.
//
// Everything that carries the texture to recover is one mesh, make_tree, with one atlas: rows of
// the upper half for the boughs, then a strip for the ribbon, then kTiles x kTileRows square tiles
// for baubles and boxes. Around the axis the boughs repeat kTreeRepeats times, the ribbon repeats
// along itself, and each tile is shown by several baubles, mirrored from front to back.
#pragma once

#include <vector>

#include "image/image.h"
#include "scenes/scene_files.h"

namespace burnish::procedural {

inline constexpr int kTreeRepeats = 3;
inline constexpr int kTiers = 5;
inline constexpr int kTiles = 8, kTileRows = 3;
inline constexpr double kTileSize = 1.0 / kTiles;  ///< in texture coordinates
inline constexpr double kBoughsEnd = 0.5;          ///< v where the ribbon's strip begins
inline constexpr double kRibbonEnd = 1 - kTileRows * kTileSize;  ///< v where the tiles begin

/// Boughs of a tier within one repeat.
constexpr int boughs_of(int tier) { return 3 + tier; }

/// v in [0, kBoughsEnd] of a place t in [0, 1] between a tier's top and its edge.
double bough_row(int tier, double t);

/// A point of a tier's upper side and the direction away from it; azimuth in turns.
struct TreePlace {
    Vec3<double> position, normal;
};
TreePlace tree_place(int tier, double turn, double t);

Mesh make_tree(std::uint32_t seed);  ///< boughs, ribbon, baubles, boxes
Mesh make_trunk();                   ///< trunk and pot
Mesh make_star();                    ///< five points, around the origin, radius 1
Mesh make_bulb();                    ///< a flame of twelve triangles, radius 1

/// Where a bulb glows; radius in scene units.
struct Bulb {
    Vec3<double> position;
    double radius = 0.02;
    Rgbf radiance;
};
/// On the boughs, and on strings that hang around the room.
std::vector<Bulb> make_bulbs(std::uint32_t seed);

/// The atlas, [size, size, 3], linear, values from 0.05 to 0.95.
Image make_tree_texture(int size, std::uint32_t seed);

/// Boards below, papered wall above, [size, size, 3], linear.
Image make_parlour_texture(int size, double floor_end, std::uint32_t seed);

}  // namespace burnish::procedural
