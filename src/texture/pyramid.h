// What the optimiser moves, and the texture that follows from it: a sum of levels of halved
// resolution, prolonged to the texture's size. The gradient by the texture becomes that by the
// levels through the transposed map, restriction, so it is an unbiased gradient of other
// parameters. One level is the texture itself, every texel on its own.
#pragma once

#include <cstdint>
#include <vector>

#include "image/image.h"
#include "texture/adam.h"
#include "texture/prolongation.h"

namespace burnish {

/// How the levels of a texture hang together: follows from the scene and the options.
struct PyramidMaps {
    Prolongation prolongation;
    std::vector<ChartBorders> borders;  ///< of each level but the coarsest: how it reads the next
    std::vector<Vec2<int>> sizes;       ///< width and height of each level, finest first
};

/// levels: at least 1; fewer where the texture is a single texel before. All levels down to one
/// texel would let the brightest part of the image decide for all others. charts: of the texels,
/// [height, width], between which nothing is shared; empty: one chart. repeats: texels at opposite
/// borders of the texture are neighbours.
PyramidMaps make_maps(int levels, int width, int height, const ChartMap& charts, bool repeats);

struct LevelState {
    Image values;
    AdamState adam;

    friend bool operator==(const LevelState&, const LevelState&) = default;
};

/// Values only.
struct PyramidState {
    std::vector<LevelState> levels;     ///< finest first, each next one half as large (rounded up)
    std::vector<std::uint32_t> visits;  ///< per texel: steps in which its gradient was not zero

    friend bool operator==(const PyramidState&, const PyramidState&) = default;
};

/// Levels whose texture is `initial` exactly: all of it in the finest. keeps_initial: whether the
/// state of several holds where they started, for weight decay and for texels that are not visited.
PyramidState encode(const PyramidMaps& maps, const Image& initial, bool keeps_initial);

/// The texture: the sum of the prolonged levels, clamped to [0, 1].
Image decode(const PyramidMaps& maps, const PyramidState& state);

/// Where `to` differs from `from`, the texture becomes `to` and starts there anew: the finest level
/// takes up the difference and forgets its gradients, and weight decay draws the sum of the levels
/// to `to`. All of the texture's size. begin: the first float of the finest level that the state
/// holds, which may be that of a part. Returns how many texels that are.
std::size_t restart(const PyramidMaps& maps, const Image& from, const Image& to,
                    PyramidState& state, Image& texture, std::size_t begin = 0);

/// The signal-to-noise gate of the texels' gradients (over some 1 / (1 - beta2) steps), 0 to 1,
/// [height, width, 1]: of the levels that a texel is a sum of the largest, each at the texel there
/// that weighs most, of its channels the least; 0 where a texel was not visited. Width 0 where the
/// gate is off.
Image confidence(const PyramidMaps& maps, const PyramidState& state);

}  // namespace burnish
