// The filter's weights of the passes in a half.
#pragma once

#include "gradient/path_cache/path_cache.h"

namespace burnish {

/// Oldest first.
inline std::vector<std::array<FilterTaps, 2>> window_taps(const PathCacheInput& input,
                                                          const CacheHalf& half,
                                                          std::size_t which) {
    const RandomKey key = half_key(input, which);
    std::vector<std::array<FilterTaps, 2>> taps;
    for (const CachedPass& pass : half.passes)
        taps.push_back(
            pass_taps(input.binding.film().filter, key, pass.film_pass, 1, input.sequence).taps[0]);
    return taps;
}

}  // namespace burnish
