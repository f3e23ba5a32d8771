// Which process has what of the views: whole views, or bands of them where there are fewer views
// than processes. What it has of a path cache and of a background follows.
#pragma once

#include "gradient/bands.h"
#include "gradient/path_cache/path_cache.h"
#include "optimize/setup.h"
#include "optimize/state.h"

namespace burnish {

/// The bands of a view, one of `views` that are fitted, that a rank owns. shared: where there are
/// fewer views than ranks, these own the bands of all views in order, each as many as the others or
/// one more; otherwise a view has one owner.
IndexRange bands_of(const Ranks& ranks, int rank, std::size_t view, std::size_t views, bool shared);

/// which: index of Setup::fitted.
IndexRange bands_of(const Setup& setup, std::size_t which, int rank);
IndexRange own_bands(const Setup& setup, std::size_t which);

/// Whether views have several owners.
bool shares_bands(const Setup& setup);

/// Makes empty what lies in other bands.
void keep_bands(const IndexRange& bands, CachedPass& pass);
void keep_bands(const IndexRange& bands, const Film& film, ViewState& view);

}  // namespace burnish
