// Packed chains + textures -> values and derivatives: the vertices sixteen at a time, then each
// chain backwards from its end and forwards from the camera. No rays, no random numbers. The plain
// twin is value_of and append_samples of paths/chains.h.
#pragma once

#include "render/shade.h"

namespace burnish {

/// What shading the chains of a tile needs besides, reused from tile to tile. Three channels per
/// block, but for the derivatives.
struct ChainScratch {
    std::vector<LaneValues> unknown_inputs;    ///< of a run
    std::vector<LaneValues> light;             ///< f(wo_light) E
    std::vector<LaneValues> next;              ///< f(wo_next)
    std::vector<LaneValues> next_derivatives;  ///< of f(wo_next), parallel to RecordMemory's
    std::vector<LaneValues> before;            ///< P_k: throughput from the camera to the vertex
    std::vector<LaneValues> behind;            ///< D_k + C_k R_{k+1}
    std::vector<char> is_finite;               ///< per lane
};

/// Adds each chain's value to its pixel, `pass` being [height, width, 3] of the tile, and sets
/// memory.derivatives to those of the chains' values by each vertex' seeds, where the shaders have
/// any. Returns the number of chains that were left out because they are not finite.
std::size_t shade_chains(std::span<const RecordShader> shaders, const TileRecords& records,
                         RecordMemory& memory, ChainScratch& scratch, std::vector<float>& pass);

}  // namespace burnish
