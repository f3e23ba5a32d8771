#include "optimize/loss.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "image/image.h"

namespace burnish {

namespace {

struct Term {
    double value, derivative;
};

Term loss_term(Loss loss, double i, double g) {
    const double d = i - g;
    switch (loss) {
        case Loss::kRelMse:
        case Loss::kReweighted:
        case Loss::kL2: {
            const double scale = square_weight(loss, g);
            return {d * d * scale, 2 * d * scale};
        }
        case Loss::kL1:
            return {std::fabs(d), d > 0 ? 1.0 : d < 0 ? -1.0 : 0.0};
    }
    return {};
}

/// Calls body(x, c, derivative) for every value of a row; returns the sum of the terms.
template <class Body>
double sum_row(Loss loss, const Image& image, const Image& target, const Image& mask, int y,
               const Body& body) {
    const double scale = 1.0 / static_cast<double>(image.values.size());
    double sum = 0;
    for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < 3; ++c) {
            const double weight = scale * mask_at(mask, x, y, c);
            if (weight == 0) {  // whatever the target holds there
                body(x, c, 0.0);
                continue;
            }
            const Term term =
                loss_term(loss, double{image.at(x, y, c)}, double{target.at(x, y, c)});
            sum += weight * term.value;
            body(x, c, weight * term.derivative);
        }
    return sum;
}

/// The sum over the rows, which are visited in parallel, in order.
template <class Row>
double sum_rows(int height, const Row& row) {
    std::vector<double> sums(static_cast<std::size_t>(height));
    parallel_for(sums.size(), [&](std::size_t y) { sums[y] = row(static_cast<int>(y)); });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
}

}  // namespace

double square_weight(Loss loss, double g) {
    switch (loss) {
        case Loss::kRelMse:
        case Loss::kReweighted:
            return 1 / (g * g + 0.01);
        case Loss::kL2:
            return 1;
        case Loss::kL1:
            return 0;
    }
    return 0;
}

double reweighted_weight(double j, double g) {
    return square_weight(Loss::kReweighted, std::max(j, std::fabs(g)));
}

bool is_unbiased(Loss loss) {
    switch (loss) {
        case Loss::kRelMse:
        case Loss::kReweighted:
        case Loss::kL2:
            return true;
        case Loss::kL1:
            return false;
    }
    return false;
}

LossValue evaluate_loss(Loss loss, const Image& image, const Image& target, const Image& mask) {
    LossValue result;
    result.adjoint = make_image(image.width, image.height, 3);
    result.value = sum_rows(image.height, [&](int y) {
        return sum_row(loss, image, target, mask, y, [&](int x, int c, double derivative) {
            result.adjoint.at(x, y, c) = static_cast<float>(derivative);
        });
    });
    return result;
}

double loss_value(Loss loss, const Image& image, const Image& target, const Image& mask) {
    return sum_rows(image.height, [&](int y) {
        return sum_row(loss, image, target, mask, y, [](int, int, double) {});
    });
}

double loss_of_halves(Loss loss, const Image& a, const Image& b, const Image& target,
                      const Image& mask) {
    const Image mean = mean_of(a, b);
    const auto value = [&](const Image& image) { return loss_value(loss, image, target, mask); };
    if (!is_unbiased(loss)) return value(mean);
    return 2 * value(mean) - 0.5 * (value(a) + value(b));  // x y = (x + y)^2 / 2 - (x^2 + y^2) / 2
}

}  // namespace burnish
