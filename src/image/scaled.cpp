// Pictures at a fraction of their size: means over exact areas.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "burnish/error.h"
#include "burnish/photograph.h"
#include "core/parallel.h"
#include "image/quality.h"
#include "image/whole.h"

namespace burnish {

namespace {

/// The part of an axis that an output pixel covers: pixels from `first`, with weights that add up
/// to 1.
struct Span {
    int first = 0;
    std::vector<double> weights;
};

std::vector<Span> make_spans(int size, int scaled, double step) {
    std::vector<Span> spans;
    for (int i = 0; i < scaled; ++i) {
        const double middle = (i + 0.5 - 0.5 * scaled) * step + 0.5 * size;
        const double begin = std::max(0.0, middle - 0.5 * step);
        const double end = std::min(double{1} * size, middle + 0.5 * step);
        constexpr double kRounding = 1e-9;  // of a border that is a whole number
        Span span{static_cast<int>(std::floor(begin + kRounding)), {}};
        span.first = std::min(span.first, size - 1);
        for (int k = span.first; k < end - kRounding; ++k)
            span.weights.push_back((std::min(k + 1.0, end) - std::max(double{1} * k, begin)) /
                                   (end - begin));
        spans.push_back(std::move(span));
    }
    return spans;
}

/// The weight of a value of a picture [height, width, 3]; 1 without a mask.
float weight_at(const Image& mask, std::size_t i) {
    return mask.width == 0 ? 1 : mask.values[mask.channels == 3 ? i : i / 3];
}

/// Means over areas of an image, times a mask of a picture.
Image average(const Image& image, const ScaledSize& size, const Image& mask = {}) {
    const std::vector<Span> columns = make_spans(image.width, size.width, size.step);
    const std::vector<Span> rows = make_spans(image.height, size.height, size.step);
    Image result = make_image(size.width, size.height, image.channels);
    parallel_for(rows.size(), [&](std::size_t y) {
        const auto row_values = static_cast<std::size_t>(image.width * image.channels);
        std::vector<double> line(row_values, 0.0);
        for (std::size_t k = 0; k < rows[y].weights.size(); ++k) {
            const std::size_t from = image.index(0, rows[y].first + static_cast<int>(k));
            for (std::size_t i = 0; i < row_values; ++i)
                line[i] +=
                    rows[y].weights[k] * double{image.values[from + i] * weight_at(mask, from + i)};
        }
        for (int x = 0; x < size.width; ++x) {
            const Span& span = columns[static_cast<std::size_t>(x)];
            for (int c = 0; c < image.channels; ++c) {
                double sum = 0;
                for (std::size_t k = 0; k < span.weights.size(); ++k)
                    sum += span.weights[k] * line[(static_cast<std::size_t>(span.first) + k) *
                                                      static_cast<std::size_t>(image.channels) +
                                                  static_cast<std::size_t>(c)];
                result.at(x, static_cast<int>(y), c) = static_cast<float>(sum);
            }
        }
    });
    return result;
}

/// Of a picture whose pixels have weights: pixels without any do not count where others do.
Image weighted_average(const Image& image, const Image& mask, const ScaledSize& size) {
    const Image plain = average(image, size);
    if (mask.width == 0) return plain;
    Image weighted = average(image, size, mask);
    const Image weights = average(mask, size);
    for (std::size_t i = 0; i < weighted.values.size(); ++i) {
        const float w = weight_at(weights, i);
        weighted.values[i] = w > 0 ? weighted.values[i] / w : plain.values[i];
    }
    return weighted;
}

/// `clipped` where the pixel counts.
Image clipped_within(const Image& mask, Image clipped) {
    const std::vector<char> counted = counted_pixels(mask);
    for (std::size_t i = 0; i < counted.size(); ++i)
        if (!counted[i]) clipped.values[i] = 0;
    return clipped;
}

void require_factor(double factor) {
    if (!(factor > 0 && factor <= 1))
        throw InputError(fmt::format("the scale is {}: expected one above 0, at most 1", factor));
}

}  // namespace

ScaledSize scaled_size(int width, int height, double factor) {
    require_factor(factor);
    if (width < 1 || height < 1)
        throw InputError(
            fmt::format("the picture has {} x {} pixels: expected at least 1 x 1", width, height));
    ScaledSize size;
    size.width = std::max(1, static_cast<int>(std::lround(width * factor)));
    size.step = double{1} * width / size.width;
    constexpr double kRounding = 1e-9;
    size.height = std::max(1, static_cast<int>(std::floor(height / size.step + kRounding)));
    return size;
}

Image scaled(const Image& image, double factor) {
    require_factor(factor);
    require_whole(image, "the image");
    if (image.values.empty()) return image;
    const ScaledSize size = scaled_size(image.width, image.height, factor);
    return size.step == 1 ? image : average(image, size);
}

Photograph scaled(Photograph p, double factor) {
    require_factor(factor);
    require_whole(p);
    if (p.image.values.empty()) return p;
    const ScaledSize size = scaled_size(p.image.width, p.image.height, factor);
    if (size.step == 1) return p;
    p.image = weighted_average(p.image, p.mask, size);
    if (p.clipped.width > 0)
        p.clipped = average(clipped_within(p.mask, std::move(p.clipped)), size);
    if (p.mask.width > 0) p.mask = average(p.mask, size);
    return p;
}

}  // namespace burnish
