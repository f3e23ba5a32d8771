#include "image/quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "image/image.h"

namespace burnish {

namespace {

bool counts(std::span<const char> counting, std::size_t i) {
    return counting.empty() || counting[i] != 0;
}

float shown(float value, float white) {
    return linear_to_srgb(std::clamp(value / white, 0.0f, 1.0f));
}

/// The derivative of `shown` by the value.
double slope_of_shown(float value, float white) {
    const double v = double{value} / double{white};
    if (v < 0 || v > 1) return 0;
    return (v <= 0.0031308 ? 12.92 : 1.055 / 2.4 * std::pow(v, 1 / 2.4 - 1)) / double{white};
}

/// [height, width]
std::vector<double> luma_of(const Image& image, float white) {
    std::vector<double> luma(image.values.size() / 3);
    for (std::size_t i = 0; i < luma.size(); ++i) {
        const float* c = &image.values[3 * i];
        luma[i] = 0.2126 * double{shown(c[0], white)} + 0.7152 * double{shown(c[1], white)} +
                  0.0722 * double{shown(c[2], white)};
    }
    return luma;
}

/// Weighted by a Gaussian window that is cut at the borders, along one axis and then the other.
std::vector<double> blurred(const std::vector<double>& from, int width, int height) {
    constexpr int kReach = 5;
    constexpr double kSigma = 1.5;
    std::array<double, kReach + 1> kernel{};
    for (int k = 0; k <= kReach; ++k)
        kernel[static_cast<std::size_t>(k)] = std::exp(-0.5 * k * k / (kSigma * kSigma));
    const auto pass = [&](const std::vector<double>& in, int step_x, int step_y) {
        std::vector<double> out(in.size());
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                double sum = 0, weights = 0;
                for (int k = -kReach; k <= kReach; ++k) {
                    const int u = x + k * step_x, v = y + k * step_y;
                    if (u < 0 || v < 0 || u >= width || v >= height) continue;
                    const double weight = kernel[static_cast<std::size_t>(std::abs(k))];
                    sum += weight * in[static_cast<std::size_t>(v * width + u)];
                    weights += weight;
                }
                out[static_cast<std::size_t>(y * width + x)] = sum / weights;
            }
        return out;
    };
    return pass(pass(from, 1, 0), 0, 1);
}

std::vector<double> product(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> result(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] * b[i];
    return result;
}

}  // namespace

std::vector<char> counted_values(const Image& mask) {
    const std::size_t repeats = mask.channels == 1 ? 3 : 1;
    std::vector<char> counted(repeats * mask.values.size());
    for (std::size_t k = 0; k < counted.size(); ++k) counted[k] = mask.values[k / repeats] > 0;
    return counted;
}

std::vector<char> counted_pixels(const Image& mask) {
    const std::vector<char> values = counted_values(mask);
    std::vector<char> counted(values.size() / 3);
    for (std::size_t k = 0; k < values.size(); ++k)
        if (values[k]) counted[k / 3] = 1;
    return counted;
}

Image alike_where_uncounted(Image reference, const Image& image, const Image& mask) {
    const std::vector<char> counted = counted_values(mask);
    for (std::size_t k = 0; k < counted.size(); ++k)
        if (!counted[k]) reference.values[k] = image.values[k];
    return reference;
}

float quantile(const Image& image, double p, std::span<const char> counting) {
    std::vector<float> values;
    for (std::size_t i = 0; i < image.values.size(); ++i)
        if (counts(counting, i)) values.push_back(image.values[i]);
    if (values.empty()) return 0;
    const auto at = static_cast<std::ptrdiff_t>(p * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
}

float white_of(const Image& picture, std::span<const char> counting) {
    return std::max(quantile(picture, 0.99, counting), 1e-6f);
}

double psnr_without_noise(const Image& a, const Image& b, const Image& reference, float white,
                          std::span<const char> counting) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        if (!counts(counting, i)) continue;
        const float mean = (a.values[i] + b.values[i]) / 2;
        const double d = double{shown(mean, white)} - double{shown(reference.values[i], white)};
        const double half_difference = (double{a.values[i]} - double{b.values[i]}) / 2;
        const double noise = slope_of_shown(mean, white) * half_difference;
        sum += d * d - noise * noise, ++count;
    }
    if (count == 0) return std::numeric_limits<double>::quiet_NaN();
    return -10 * std::log10(std::max(0.0, sum / count));
}

double ssim(const Image& image, const Image& reference, float white, std::span<const char> pixels) {
    constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;
    const auto blur = [&](const std::vector<double>& v) {
        return blurred(v, image.width, image.height);
    };
    const auto a = luma_of(image, white), b = luma_of(reference, white);
    const auto mean_a = blur(a), mean_b = blur(b);
    const auto aa = blur(product(a, a)), bb = blur(product(b, b)), ab = blur(product(a, b));
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!pixels.empty() && !pixels[i]) continue;
        const double ma = mean_a[i], mb = mean_b[i];
        const double va = aa[i] - ma * ma, vb = bb[i] - mb * mb, cov = ab[i] - ma * mb;
        sum +=
            (2 * ma * mb + kC1) * (2 * cov + kC2) / ((ma * ma + mb * mb + kC1) * (va + vb + kC2));
        ++count;
    }
    return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace burnish
