#include "burnish/inverse/loss.h"

#include <cmath>

namespace burnish {

namespace {

struct Term {
    double value, derivative;
};

Term loss_term(Loss loss, double i, double g) {
    const double d = i - g;
    switch (loss) {
        case Loss::kRelMse: {
            const double scale = 1 / (g * g + 0.01);
            return {d * d * scale, 2 * d * scale};
        }
        case Loss::kL2:
            return {d * d, 2 * d};
        case Loss::kL1:
            return {std::fabs(d), d > 0 ? 1.0 : d < 0 ? -1.0 : 0.0};
    }
    return {};
}

}  // namespace

bool is_unbiased(Loss loss) { return loss != Loss::kL1; }

LossValue evaluate_loss(Loss loss, const Image& image, const Image& target, const Image& mask) {
    LossValue result;
    result.adjoint = make_image(image.width, image.height, 3);
    const double scale = 1.0 / static_cast<double>(image.values.size());
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < 3; ++c) {
                const double weight =
                    scale *
                    (mask.width == 0 ? 1.0 : double{mask.at(x, y, mask.channels == 3 ? c : 0)});
                const Term term =
                    loss_term(loss, double{image.at(x, y, c)}, double{target.at(x, y, c)});
                result.value += weight * term.value;
                result.adjoint.at(x, y, c) = static_cast<float>(weight * term.derivative);
            }
    return result;
}

}  // namespace burnish
