// What can be chosen of a procedural scene.
#pragma once

#include <cstdint>

namespace burnish {

struct ProceduralOptions {
    int texture_size = 2048;  ///< width and height of the main texture, texels; 16 to 8192
    std::uint32_t seed = 1;   ///< moves scratches, spots, lights and clouds
};

}  // namespace burnish
