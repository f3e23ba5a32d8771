// The largest contributions of a pool. Its records are differentiated sixteen at a time and never
// one by one, so only those records are looked at closely that could be among the largest: their
// derivatives exceed what kMaxOutliers contributions, found by whichever thread, are known to reach.
// Whatever is skipped is below the last of the result, so threads do not change it.
#pragma once

#include <atomic>
#include <limits>

#include "gradient/differentiate.h"
#include "gradient/outliers.h"
#include "render/records.h"

namespace burnish {

struct OutlierSearch {
    /// No contribution below it is one of the largest.
    std::atomic<float> least{std::numeric_limits<float>::min()};
    std::vector<std::vector<Outlier>> found;  ///< per band of work
};

/// One bank's records as differentiate() takes them.
struct RecordView {
    DerivativeInput input;  ///< its adjoint is scaled by `share`, as that of the packets
    float share = 1;
};

/// Where a block of records comes from.
struct RecordPlace {
    const TileRecords* records = nullptr;
    const RecordRun* run = nullptr;
    std::uint32_t block = 0;  ///< index into records->blocks
    Tile tile;
    std::uint32_t film_pass = 0;
};

/// What `bound` must reach for look_closer to be worth calling. Packets and plain floats round
/// differently: a hundredth is far above it.
inline Packet worth_looking(const OutlierSearch& search, float share) {
    return Packet(0.99f * search.least.load(std::memory_order_relaxed) * share);
}

/// Looks at those records of a block whose `bound`, above every contribution of theirs times
/// view.share, is worth it. Only one thread works on a band.
void look_closer(const RecordView& view, const RecordPlace& place, const Packet& bound,
                 std::size_t band, OutlierSearch& search);

/// The largest of all bands.
std::vector<Outlier> result_of(const OutlierSearch& search);

}  // namespace burnish
