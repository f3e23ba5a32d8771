// The film: passes of camera samples -> image, and the adjoint of that map.
//
// All samples of a pass share one offset within their pixels, so reconstruction is a separable
// convolution of the pass whose weights depend on the offset alone. h_j is normalised by its exact
// integral over the film (clipped at the border of the crop window), never by realised weights:
// unbiased for any filter, negative lobes included.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "image/image.h"
#include "paths/path.h"
#include "scene/camera.h"

namespace burnish {

/// The most pixels on one axis that a sample reaches: 2 * halo + 1.
inline constexpr int kMaxTaps = 15;

/// Weights of one axis: a sample in pixel x adds weight[k] to pixel x + k - halo.
struct FilterTaps {
    int halo = 0;
    std::array<float, kMaxTaps> weight{};
};

/// Pixels beyond its own that a sample reaches. Throws InputError where the filter's radius exceeds
/// kMaxFilterRadius (shading/filter.h).
int filter_halo(const ReconstructionFilter& filter);
/// offset in [0, 1): film position within the pixel.
FilterTaps filter_taps(const ReconstructionFilter& filter, float offset);

/// The taps (x, y) of consecutive passes of a job: taps[k] are those of film pass first + k; and of
/// single ones before them, in ascending order.
struct PassTaps {
    std::uint32_t first = 0;
    std::vector<std::array<FilterTaps, 2>> taps;
    std::vector<std::uint32_t> earlier = {};
    std::vector<std::array<FilterTaps, 2>> earlier_taps = {};  ///< parallel to earlier

    const std::array<FilterTaps, 2>& operator[](std::uint32_t film_pass) const {
        if (film_pass >= first) return taps[film_pass - first];
        const auto at = std::lower_bound(earlier.begin(), earlier.end(), film_pass);
        return earlier_taps[static_cast<std::size_t>(at - earlier.begin())];
    }
};
PassTaps pass_taps(const ReconstructionFilter& filter, RandomKey key, std::uint32_t first,
                   std::uint32_t count, Sequence sequence = Sequence::kIndependent);

/// 1 / integral of h_j over the film, factored into columns and rows of the crop window.
struct FilmNormalization {
    std::vector<float> x, y;
};
FilmNormalization film_normalization(const Film& film);

/// image_j *= scale / integral of h_j: sums of weighted samples become an image.
void normalize_film(const FilmNormalization& normalization, float scale, Image& image);

/// scale dL/dI_j divided by the integral of h_j: what adjoint_weight reads. adjoint: [crop_height,
/// crop_width, 3].
Image normalized_adjoint(const Image& adjoint, const FilmNormalization& normalization,
                         float scale = 1);

/// w(x) = sum_j dL/dI_j h_j(x) [PR eq. 5] for a film position given by its pixel and taps; RGB.
Rgbf adjoint_weight(const Image& normalized_adjoint, int pixel_x, int pixel_y,
                    const FilterTaps& taps_x, const FilterTaps& taps_y);

}  // namespace burnish
