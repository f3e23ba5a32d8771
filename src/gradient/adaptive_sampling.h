// On which pixels the camera samples of the derivative are spent.
//
// Pixel j gets n_j samples, e_j of them expected, and each counts 1 / e_j. The estimate is unbiased
// whatever e_j > 0, as long as e_j is known before the samples are drawn. With second moments
// E|g|^2 of a pixel's part in the gradient, the variance sum_j E|g|^2 / e_j is least for e_j in
// proportion to the root of E|g|^2, which is |w| times the size of the value's derivative: w(x),
// the adjoint seen through the filter, is known exactly, the size is learnt from earlier
// iterations. A share of the samples is spread evenly, so that no pixel is ever forgotten.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gradient/binding.h"
#include "paths/trace.h"

namespace burnish {

/// A pixel gets at most so many times m samples in an iteration.
inline constexpr std::uint32_t kMaxOfMean = 16;
/// And at least this share of m is expected where an unknown can be seen.
inline constexpr float kUniformShare = 0.25f;

/// What samples of earlier iterations said about the pixels, one entry per pixel of the crop
/// window. Values only.
struct PixelStatistics {
    std::vector<char> seen;      ///< non-zero: can see an unknown
    std::vector<float> squares;  ///< sum of |g|^2 / |w|^2 over samples; old ones count for less
    std::vector<float> counts;   ///< number of samples; old ones count for less

    friend bool operator==(const PixelStatistics&, const PixelStatistics&) = default;
};

/// Nothing is known but which pixels can see unknowns.
PixelStatistics make_pixel_statistics(const Binding& binding);

/// e_j of every pixel: 0 where no unknown can be seen, elsewhere from kUniformShare *
/// mean to kMaxOfMean * mean, on average `mean` or, where few pixels carry the adjoint, less. mean:
/// m, above 0.
std::vector<float> expected_samples(const Film& film, const Image& normalized_adjoint, float mean,
                                    const PixelStatistics& statistics);

/// Camera samples of an iteration, neighbours together: n_j is e_j rounded up or down at random. A
/// pixel's passes are a run of [0, passes) that begins anywhere and goes round, so that the film
/// offset of a sample does not depend on how many there are. passes: at least every e_j, rounded
/// up.
std::vector<BatchSample> choose_samples(const Film& film, std::span<const float> expected,
                                        std::uint32_t seed, std::uint32_t iteration,
                                        std::uint32_t passes);

/// |g|^2 / |w|^2 of one path, g over all texels that it touches; 0 where w is.
struct PixelSquare {
    std::uint32_t pixel = 0;
    float square = 0;
};

/// Takes in an iteration: its camera samples, and the squares of those paths that brought anything.
void update_statistics(std::span<const BatchSample> samples, std::span<const PixelSquare> squares,
                       PixelStatistics& statistics);

}  // namespace burnish
