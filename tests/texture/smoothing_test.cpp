// Smoothing along rows and columns: solves the equation it says, within charts alone.
#include "texture/smoothing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "random_source.h"

namespace burnish {
namespace {

Image random_image(int width, int height, int channels, std::uint32_t seed) {
    test::RandomSource random{seed};
    Image image = make_image(width, height, channels);
    for (float& v : image.values) v = random.next(-1.0f, 1.0f);
    return image;
}

ChartMap random_charts(int width, int height, std::uint32_t seed) {
    test::RandomSource random{seed};
    ChartMap charts;
    for (int i = 0; i < width * height; ++i)
        charts.push_back(static_cast<std::uint32_t>(random.next(0.0f, 3.0f)));
    return charts;
}

bool linked(const ChartMap& charts, const Image& image, int x0, int y0, int x1, int y1) {
    if (x0 < 0 || y0 < 0 || x1 >= image.width || y1 >= image.height) return false;
    if (charts.empty()) return true;
    const std::uint32_t a = charts[static_cast<std::size_t>(y0 * image.width + x0)],
                        b = charts[static_cast<std::size_t>(y1 * image.width + x1)];
    return a == b && a != 0;
}

/// The largest |(I + lambda D) x - r| of a direction, in doubles.
double residual(const ChartMap& charts, float lambda, bool rows, const Image& x, const Image& r) {
    const int dx = rows ? 1 : 0, dy = rows ? 0 : 1;
    double largest = 0;
    for (int y = 0; y < x.height; ++y)
        for (int i = 0; i < x.width; ++i)
            for (int c = 0; c < x.channels; ++c) {
                double left = double{x.at(i, y, c)};
                if (linked(charts, x, i - dx, y - dy, i, y))
                    left +=
                        double{lambda} * (double{x.at(i, y, c)} - double{x.at(i - dx, y - dy, c)});
                if (linked(charts, x, i, y, i + dx, y + dy))
                    left +=
                        double{lambda} * (double{x.at(i, y, c)} - double{x.at(i + dx, y + dy, c)});
                largest = std::max(largest, std::abs(left - double{r.at(i, y, c)}));
            }
    return largest;
}

TEST(Smoothing, SolvesTheEquation) {
    for (const auto& [width, height] : {std::pair{1, 1}, {7, 1}, {1, 33}, {37, 18}, {100, 70}})
        for (const int channels : {1, 3})
            for (const float lambda : {0.0f, 0.3f, 400.0f})
                for (const bool charted : {false, true}) {
                    const ChartMap charts = charted ? random_charts(width, height, 5) : ChartMap{};
                    const TexelLinks links = link_texels(width, height, charts);
                    const Image given = random_image(width, height, channels, 6);
                    for (const bool rows : {true, false}) {
                        Image x = given;
                        (rows ? smooth_rows : smooth_columns)(links, lambda, x);
                        EXPECT_LT(residual(charts, lambda, rows, x, given),
                                  1e-6 * (1 + 4 * double{lambda}))
                            << width << " x " << height << ", " << lambda;
                        EXPECT_TRUE(lambda != 0 || x.values == given.values);
                    }
                }
}

TEST(Smoothing, SpreadsOverSomeRootOfLambdaTexels) {
    Image x = make_image(201, 1, 1);
    x.at(100, 0, 0) = 1;
    smooth_rows(link_texels(201, 1, {}), 25.0f, x);
    double sum = 0, second = 0;
    for (int i = 0; i < 201; ++i) {
        sum += double{x.at(i, 0, 0)};
        second += double{x.at(i, 0, 0)} * (i - 100.0) * (i - 100.0);
    }
    EXPECT_NEAR(sum, 1, 1e-5);
    EXPECT_NEAR(second, 2 * 25, 0.01);  // the variance of the kernel is 2 lambda
}

}  // namespace
}  // namespace burnish
