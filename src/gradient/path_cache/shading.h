// What the stages of a pool share.
#pragma once

#include "gradient/path_cache/path_cache.h"
#include "render/shade.h"

namespace burnish {

/// Bands of tiles that gather texels apart: enough for many threads, few enough that neighbouring
/// tiles share their sums.
inline constexpr std::size_t kPoolBands = 32;

/// The random numbers of a bank.
inline RandomKey bank_key(const PoolInput& input, std::size_t bank) {
    return {input.seed, bank == 0 ? Stream::kPoolA : Stream::kPoolB};
}

/// Everything that shading reads, for one iteration.
struct PoolShading {
    TextureTable textures;
    std::vector<RecordShader> shaders;

    PoolShading(const Scene& scene, const Theta& theta)
        : textures(texture_table(scene, theta)),
          shaders(make_record_shaders(scene, textures, theta_slots(scene, theta))) {}
    PoolShading(const PoolShading&) = delete;
    PoolShading& operator=(const PoolShading&) = delete;

    const RecordShader& operator[](BsdfId id) const {
        return shaders[static_cast<std::size_t>(id.value)];
    }
};

}  // namespace burnish
