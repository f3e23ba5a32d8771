// How alike two pictures look. counting: for each value of a picture whether it counts, not 0;
// none: all do.
#pragma once

#include <span>
#include <vector>

#include "burnish/image.h"

namespace burnish {

/// Whether each value of a picture [height, width, 3] counts under a mask [height, width, 1 or 3]:
/// its weight is above 0. Empty where there is no mask.
std::vector<char> counted_values(const Image& mask);
/// Whether each pixel counts: a value of it does. Empty where there is no mask.
std::vector<char> counted_pixels(const Image& mask);

/// The reference with the image's values where the mask has no weight: they do not differ there.
Image alike_where_uncounted(Image reference, const Image& image, const Image& mask);

/// The p-th quantile, p in [0, 1], of the values that count.
float quantile(const Image& image, double p, std::span<const char> counting = {});

/// What is shown as white: the 99th percentile of the values that count.
float white_of(const Image& picture, std::span<const char> counting = {});

/// Peak signal-to-noise ratio in dB of two linear pictures [height, width, 3] as they are shown:
/// divided by `white`, clamped to [0, 1], sRGB-coded. The first is the mean of a and b, pictures
/// with independent noise: less what their noise adds to first order in what is shown. Strong noise
/// adds more, since codes are concave in the light. Infinite where nothing else differs, NaN where
/// no value counts.
double psnr_without_noise(const Image& a, const Image& b, const Image& reference, float white,
                          std::span<const char> counting = {});

/// Structural similarity [Wang et al. 2004] of the luma of the same, with Gaussian windows of 1.5
/// pixels, as the mean over the pixels that count; 1: equal. pixels: one for each.
double ssim(const Image& image, const Image& reference, float white,
            std::span<const char> pixels = {});

}  // namespace burnish
