// The gradient by resampled importance sampling, with reuse across iterations: the paper's method
// and its ablations, on one code path.
//
//   fresh samples -> candidates (texel, q, g)                 [PR eq. 14, alg. 2]
//   candidates of a texel -> current reservoirs               [PR eq. 11]
//   current + history -> merged reservoirs -> gradient        [PR eq. 12-13, alg. 3]
#pragma once

#include <optional>

#include "gradient/path_cache/path_cache.h"
#include "gradient/reservoirs/history.h"
#include "gradient/texel_gradient.h"

namespace burnish {

/// What the next iteration reads: values only.
struct ReservoirsState {
    History history;         ///< with Reservoirs::reuse
    PixelStatistics pixels;  ///< with Reservoirs::adaptive_sampling
    PathCacheState image;    ///< with Reservoirs::image_window

    friend bool operator==(const ReservoirsState&, const ReservoirsState&) = default;
};

/// Whether the history keeps the vertices of paths, so that no ray is traced where light bounces.
bool keeps_vertices(const Reservoirs& options, const Scene& scene);

/// One estimate for the adjoint dL/dI [crop_height, crop_width, 3]. state: of the iteration before,
/// under the same options; becomes that of this one. replaced: takes the history that it replaces,
/// unless it has one.
GradientResult estimate_gradient(const Reservoirs& options, const Binding& binding,
                                 const Image& adjoint, std::uint32_t seed, std::uint32_t iteration,
                                 ReservoirsState& state,
                                 std::optional<History>* replaced = nullptr);

}  // namespace burnish
