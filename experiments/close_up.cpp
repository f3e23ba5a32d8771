#include "experiments/close_up.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace burnish {

namespace {

/// Of the pixels above and to the left: [height + 1, width + 1].
std::vector<double> summed_differences(const Image& a, const Image& b) {
    const auto stride = static_cast<std::size_t>(a.width) + 1;
    std::vector<double> sums(stride * (static_cast<std::size_t>(a.height) + 1));
    for (int y = 0; y < a.height; ++y) {
        double row = 0;
        for (int x = 0; x < a.width; ++x) {
            for (int c = 0; c < a.channels; ++c)
                row += std::abs(double{a.at(x, y, c)} - double{b.at(x, y, c)});
            const std::size_t above =
                static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x) + 1;
            sums[above + stride] = sums[above] + row;
        }
    }
    return sums;
}

}  // namespace

Square most_different(const Image& a, const Image& b) {
    const std::vector<double> sums = summed_differences(a, b);
    const auto sum = [&](int x, int y) {
        return sums[static_cast<std::size_t>(y) * (static_cast<std::size_t>(a.width) + 1) +
                    static_cast<std::size_t>(x)];
    };
    Square best{0, 0, std::max(1, std::min(a.width, a.height) / 3)};
    double max_sum = -1;
    for (int y = 0; y + best.side <= a.height; ++y)
        for (int x = 0; x + best.side <= a.width; ++x) {
            const int right = x + best.side, below = y + best.side;
            const double inside = sum(right, below) - sum(x, below) - sum(right, y) + sum(x, y);
            if (inside > max_sum) max_sum = inside, best.x = x, best.y = y;
        }
    return best;
}

Image close_up(const Image& image, const Square& square) {
    Image part = make_image(square.side, square.side, image.channels);
    for (int y = 0; y < square.side; ++y)
        for (int x = 0; x < square.side; ++x)
            for (int c = 0; c < image.channels; ++c)
                part.at(x, y, c) = image.at(square.x + x, square.y + y, c);
    return part;
}

}  // namespace burnish
