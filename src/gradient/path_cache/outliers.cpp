#include "gradient/path_cache/outliers.h"

namespace burnish {

namespace {

/// least = max(least, value)
void raise(std::atomic<float>& least, float value) {
    float now = least.load(std::memory_order_relaxed);
    while (now < value && !least.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
    }
}

/// The record with all its names.
PathRecord record_at(const RecordView& view, const RecordPlace& place, std::size_t lane) {
    PathRecord record = unpack_record(place.records->blocks[place.block], lane, place.run->bsdf,
                                      place.tile, view.input.normalized_adjoint->width);
    record.film_pass = place.film_pass;
    const std::size_t direct_sample = kLanes * std::size_t{place.block - place.run->begin} + lane;
    record.technique = direct_sample < place.run->light_samples ? Technique::kEmitter : Technique::kBsdf;
    return record;
}

}  // namespace

void look_closer(const RecordView& view, const RecordPlace& place, const Packet& bound,
                 std::size_t band, OutlierSearch& search) {
    std::vector<Outlier>& found = search.found[band];
    const Packet worth = worth_looking(search, view.share);
    TexelDerivatives touched;
    for (int lane = 0; lane < kLanes; ++lane) {
        if (!(get(bound, lane) >= get(worth, lane))) continue;
        const PathRecord record = record_at(view, place, static_cast<std::size_t>(lane));
        differentiate(view.input, record, touched);
        for (int k = 0; k < touched.count; ++k) {
            const TexelDerivative& d = touched.items[static_cast<std::size_t>(k)];
            const float value = largest_channel(d.g) / view.share;
            if (std::isfinite(value) && value >= search.least.load(std::memory_order_relaxed))
                found.push_back({value, record.pixel, d.key.slot, d.key.texel, record.technique});
        }
    }
    if (found.size() < 2 * kMaxOutliers) return;
    keep_largest(found);
    raise(search.least, found.back().value);
}

std::vector<Outlier> result_of(const OutlierSearch& search) {
    std::vector<Outlier> all;
    for (const auto& band : search.found) all.insert(all.end(), band.begin(), band.end());
    keep_largest(all);
    return all;
}

}  // namespace burnish
