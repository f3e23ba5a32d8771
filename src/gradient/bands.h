// A view in bands of neighbouring tiles: several processes can share them out, and threads do.
//
// The gradient of a view is the sum over its bands by a binary tree: a node of s bands, a power of
// two, begins at a multiple of s and is the sum of its two halves. Who works on which bands decides
// on no byte of it.
#pragma once

#include <algorithm>
#include <vector>

#include "core/index_range.h"

namespace burnish {

/// Of a view: enough for many threads, few enough that neighbouring tiles share their sums.
inline constexpr std::size_t kViewBands = 32;

/// All bands of a view.
inline constexpr IndexRange kAllBands{0, kViewBands};

/// Those of `count` items, as rows of pixels, that lie in the bands.
inline IndexRange items_of(const IndexRange& bands, std::size_t count) {
    return {count * bands.begin / kViewBands, count * bands.end / kViewBands};
}

/// Those of `count` tiles, whose sums of texels bands make, that lie in the bands: where there are
/// few, a band has several or none, so that neighbouring tiles share their sums.
inline IndexRange tiles_of(const IndexRange& bands, std::size_t count) {
    const std::size_t each = (count + kViewBands - 1) / kViewBands;
    const IndexRange runs = items_of(bands, each == 0 ? 0 : (count + each - 1) / each);
    return {std::min(count, runs.begin * each), std::min(count, runs.end * each)};
}

/// The fewest nodes of the tree that the bands fill, in order.
inline std::vector<IndexRange> nodes_of(const IndexRange& bands) {
    std::vector<IndexRange> nodes;
    for (std::size_t at = bands.begin; at < bands.end; at = nodes.back().end) {
        std::size_t size = kViewBands;
        while (at % size != 0 || at + size > bands.end) size /= 2;
        nodes.push_back({at, at + size});
    }
    return nodes;
}

}  // namespace burnish
