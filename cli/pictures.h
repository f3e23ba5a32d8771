// Images for people: tone mapping, false colours, small versions, data URIs.
#pragma once

#include <span>
#include <string>

#include "image/image.h"

namespace burnish {

/// The factor that brings the 99th percentile of the channels' maximum to white. 1 where none does,
/// as of a black image. counting: of each pixel; empty: all count.
float display_scale(const Image& image, std::span<const char> counting = {});

/// image * scale; what exceeds 1 is clipped when it is encoded.
Image brightened(const Image& image, float scale);

/// Root of the relative squared error per pixel, averaged over channels [height, width, 1]:
/// sqrt(mean_c (I - G)^2 / (G^2 + 0.01)), the summand of relMSE.
Image relative_error(const Image& image, const Image& target);

/// |a - b|, averaged over channels [height, width, 1].
Image absolute_error(const Image& a, const Image& b);

/// A one-channel image in false colours, sRGB-encoded: black, violet, red, orange, pale yellow for
/// 0 to `white`; black for NaN.
Image false_color(const Image& image, float white);

/// A signed image in colours, sRGB-encoded: red for +white, white for 0, blue for -white; several
/// channels are averaged.
Image signed_color(const Image& image, float white);

/// CSS colours of false_color from low to high.
const char* false_color_gradient();

/// Averaged down so that no side exceeds `max` pixels; smaller images stay as they are. counting:
/// of each pixel; empty: all count. What does not count is in no average; 0 where nothing counts.
Image shrink(const Image& image, int max, std::span<const char> counting = {});

/// A PNG as a data URI.
std::string png_data_uri(const Image& image, bool srgb);

std::string base64(const std::string& bytes);

}  // namespace burnish
