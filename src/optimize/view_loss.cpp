#include "optimize/view_loss.h"

#include <limits>

#include "image/image.h"
#include "optimize/loss.h"

namespace burnish {

namespace {

bool has_own_exposure(const View& view) { return view.exposure != std::array<float, 3>{1, 1, 1}; }

}  // namespace

Image exposed(const View& view, Image image) {
    if (!has_own_exposure(view)) return image;
    for (std::size_t i = 0; i < image.values.size(); ++i) image.values[i] *= view.exposure[i % 3];
    return image;
}

LossValue loss_of(const Setup& setup, std::size_t view, const Image& image) {
    const View& v = setup.problem.views[view];
    const auto evaluate = [&](const Image& shown) {
        return setup.problem.loss ? setup.problem.loss(shown, view)
                                  : evaluate_loss(setup.options.loss, shown, v.image, v.mask);
    };
    if (!has_own_exposure(v)) return evaluate(image);
    LossValue loss = evaluate(exposed(v, image));
    loss.adjoint = exposed(v, std::move(loss.adjoint));
    return loss;
}

double loss_value_of(const Setup& setup, std::size_t view, const Image& image) {
    const View& v = setup.problem.views[view];
    const auto evaluate = [&](const Image& shown) {
        return setup.problem.loss ? setup.problem.loss(shown, view).value
                                  : loss_value(setup.options.loss, shown, v.image, v.mask);
    };
    return has_own_exposure(v) ? evaluate(exposed(v, image)) : evaluate(image);
}

double held_out_loss(const Setup& setup, std::size_t view, const Image& a, const Image& b) {
    const View& v = setup.problem.views[view];
    if (setup.problem.loss) return loss_value_of(setup, view, mean_of(a, b));
    if (!has_own_exposure(v)) return loss_of_halves(setup.options.loss, a, b, v.image, v.mask);
    return loss_of_halves(setup.options.loss, exposed(v, a), exposed(v, b), v.image, v.mask);
}

double noise_floor(const Setup& setup, std::size_t view, const Image& a, const Image& b) {
    if (setup.problem.loss || !is_unbiased(setup.options.loss))
        return std::numeric_limits<double>::quiet_NaN();
    // These losses are quadratic in I - G: the noise alone, put on top of the target.
    const View& v = setup.problem.views[view];
    Image noisy = v.image;
    for (std::size_t i = 0; i < noisy.values.size(); ++i)
        noisy.values[i] += 0.5f * v.exposure[i % 3] * (a.values[i] - b.values[i]);
    return loss_value(setup.options.loss, noisy, v.image, v.mask);
}

}  // namespace burnish
