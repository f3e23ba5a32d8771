#include "cli/pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "image/quality.h"

namespace burnish {

namespace {

/// Stops of the false colours, sRGB codes, evenly spaced.
constexpr Rgbf kStops[] = {{10, 8, 24},    {66, 18, 104},  {140, 35, 110}, {205, 63, 74},
                           {243, 120, 38}, {252, 189, 73}, {253, 250, 204}};
constexpr const char* kStopsCss = "#0a0818, #421268, #8c236e, #cd3f4a, #f37826, #fcbd49, #fdfacc";

Rgbf false_color_of(float share) {
    constexpr int kLast = static_cast<int>(std::size(kStops)) - 1;
    const float at = share > 0 ? std::min(share, 1.0f) * kLast : 0;
    const int i = std::min(static_cast<int>(at), kLast - 1);
    const float t = at - static_cast<float>(i);
    return (kStops[i] * (1 - t) + kStops[i + 1] * t) * (1.0f / 255);
}

template <class Error>
Image error_image(const Image& a, const Image& b, Error error) {
    Image result = make_image(a.width, a.height, 1);
    const auto channels = static_cast<std::size_t>(a.channels);
    for (std::size_t i = 0; i < result.values.size(); ++i) {
        double sum = 0;
        for (std::size_t c = 0; c < channels; ++c)
            sum += error(double{a.values[i * channels + c]}, double{b.values[i * channels + c]});
        result.values[i] = static_cast<float>(sum / a.channels);
    }
    return result;
}

}  // namespace

float display_scale(const Image& image, std::span<const char> counting) {
    Image brightest = make_image(image.width, image.height, 1);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < image.channels; ++c)
                brightest.at(x, y, 0) = std::max(brightest.at(x, y, 0), image.at(x, y, c));
    const float scale = 1 / quantile(brightest, 0.99, counting);
    return scale > 0 && std::isfinite(scale) ? scale : 1;
}

Image brightened(const Image& image, float scale) {
    Image result = image;
    for (float& v : result.values) v *= scale;
    return result;
}

Image relative_error(const Image& image, const Image& target) {
    Image error = error_image(
        image, target, [](double i, double g) { return (i - g) * (i - g) / (g * g + 0.01); });
    for (float& v : error.values) v = std::sqrt(v);
    return error;
}

Image absolute_error(const Image& a, const Image& b) {
    return error_image(a, b, [](double x, double y) { return std::fabs(x - y); });
}

Image false_color(const Image& image, float white) {
    Image result = make_image(image.width, image.height, 3);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const Rgbf color = false_color_of(image.at(x, y, 0) / white);
            for (int c = 0; c < 3; ++c) result.at(x, y, c) = color[c];
        }
    return result;
}

Image signed_color(const Image& image, float white) {
    Image result = make_image(image.width, image.height, 3);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            float sum = 0;
            for (int c = 0; c < image.channels; ++c) sum += image.at(x, y, c);
            const float share =
                std::clamp(sum / (static_cast<float>(image.channels) * white), -1.0f, 1.0f);
            const Rgbf end = share > 0 ? Rgbf{0.70f, 0.09f, 0.17f} : Rgbf{0.13f, 0.40f, 0.67f};
            const Rgbf none{0.97f, 0.97f, 0.96f};
            const Rgbf color = none + (end - none) * std::fabs(share);
            for (int c = 0; c < 3; ++c) result.at(x, y, c) = color[c];
        }
    return result;
}

const char* false_color_gradient() { return kStopsCss; }

Image shrink(const Image& image, int max, std::span<const char> counting) {
    const int factor = std::max(1, (std::max(image.width, image.height) + max - 1) / max);
    if (factor == 1 && counting.empty()) return image;
    const auto counts = [&](int x, int y) {
        return counting.empty() || counting[static_cast<std::size_t>(y) * image.width + x] != 0;
    };
    Image small = make_image((image.width + factor - 1) / factor,
                             (image.height + factor - 1) / factor, image.channels);
    for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x)
            for (int c = 0; c < small.channels; ++c) {
                double sum = 0;
                int count = 0;
                for (int v = y * factor; v < std::min((y + 1) * factor, image.height); ++v)
                    for (int u = x * factor; u < std::min((x + 1) * factor, image.width); ++u)
                        if (counts(u, v)) sum += double{image.at(u, v, c)}, ++count;
                small.at(x, y, c) = count > 0 ? static_cast<float>(sum / count) : 0;
            }
    return small;
}

std::string base64(const std::string& bytes) {
    constexpr const char* kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = group << 8 | (k < n ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += k <= n ? kDigits[group >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

std::string png_data_uri(const Image& image, bool srgb) {
    return "data:image/png;base64," + base64(encode_png(image, srgb));
}

}  // namespace burnish
