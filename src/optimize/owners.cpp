#include "optimize/owners.h"

#include "optimize/ranks.h"

namespace burnish {

IndexRange bands_of(const Ranks& ranks, int rank, std::size_t view, std::size_t views,
                    bool shared) {
    if (!shared || views >= static_cast<std::size_t>(ranks.count))
        return owner_of(ranks, view, views) == rank ? kAllBands : IndexRange{};
    const std::size_t first = view * kViewBands;
    const IndexRange own =
        overlap(run_of(ranks, rank, views * kViewBands), {first, first + kViewBands});
    return own.empty() ? IndexRange{} : IndexRange{own.begin - first, own.end - first};
}

IndexRange bands_of(const Setup& setup, std::size_t which, int rank) {
    return bands_of(setup.problem.ranks, rank, which, setup.fitted.size(),
                    shares_bands(setup.options.estimator));
}

IndexRange own_bands(const Setup& setup, std::size_t which) {
    return bands_of(setup, which, setup.problem.ranks.rank);
}

bool shares_bands(const Setup& setup) {
    return renders_together(setup) && shares_bands(setup.options.estimator);
}

void keep_bands(const IndexRange& bands, CachedPass& pass) {
    const IndexRange own = tiles_of(bands, pass.tiles.size());
    for (std::size_t i = 0; i < pass.tiles.size(); ++i)
        if (i < own.begin || i >= own.end) pass.tiles[i] = {};
}

void keep_bands(const IndexRange& bands, const Film& film, ViewState& view) {
    if (bands == kAllBands) return;
    for (CacheHalf& half : kept_cache(view.estimator).halves)
        for (CachedPass& pass : half.passes) keep_bands(bands, pass);
    const auto height = static_cast<std::size_t>(film.crop_height);
    for (Background& b : view.backgrounds)
        if (b.mean.height == film.crop_height) b = rows_of(b, items_of(bands, height));
}

}  // namespace burnish
