// Images that tests make and compare.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "image/image.h"
#include "random_source.h"
#include "worst.h"

namespace burnish::test {

/// Values uniform in [low, high).
inline Image random_image(int width, int height, int channels, float low, float high,
                          std::uint32_t seed) {
    RandomSource random{seed};
    Image image = make_image(width, height, channels);
    for (float& v : image.values) v = random.next(low, high);
    return image;
}

/// The largest difference of two images, relative to the largest value of b.
inline double difference(const Image& a, const Image& b) {
    double worst = 0, largest = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        worst = worse(worst, std::abs(double{a.values[i]} - double{b.values[i]}));
        largest = std::max(largest, std::abs(double{b.values[i]}));
    }
    return worst / largest;
}

}  // namespace burnish::test
