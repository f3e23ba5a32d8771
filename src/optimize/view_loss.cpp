#include "optimize/view_loss.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "burnish/error.h"
#include "core/dirty_blocks.h"
#include "core/parallel.h"
#include "image/image.h"
#include "image/whole.h"
#include "optimize/exposure.h"
#include "optimize/loss.h"

namespace burnish {

namespace {

constexpr ExposureFactors kNone{1, 1, 1};

/// That of the problem. Throws InputError where its adjoint is not of the image's shape.
LossValue own_loss(const Setup& setup, std::size_t view, const Image& image) {
    LossValue loss = setup.problem.loss(image, view);
    const Image& a = loss.adjoint;
    if (a.width == image.width && a.height == image.height && a.channels == 3 && is_whole(a))
        return loss;
    throw InputError(
        fmt::format("the adjoint of the loss has {} x {} pixels, {} channels and {} values: "
                    "expected those of the image, {} x {}, 3 and {}",
                    a.width, a.height, a.channels, a.values.size(), image.width, image.height,
                    image.values.size()));
}

}  // namespace

Image exposed(const ExposureFactors& exposure, Image image) {
    if (exposure == kNone) return image;
    for (std::size_t i = 0; i < image.values.size(); ++i) image.values[i] *= exposure[i % 3];
    return image;
}

ExposureFactors exposure_of(const Setup& setup, std::size_t view, const Image& a, const Image& b,
                            const ExposureFactors& last) {
    const View& v = setup.problem.views[view];
    if (const auto* factors = std::get_if<ExposureFactors>(&v.exposure)) return *factors;
    return fit_exposure(std::get<FitExposure>(v.exposure), setup.options.loss, {a, b},
                        {v.image, v.mask}, last);
}

ExposureFactors stepped_exposure_of(const Setup& setup, std::size_t view, const Image& a,
                                    const Image& b, const ExposureFactors& last) {
    const View& v = setup.problem.views[view];
    const auto* how = std::get_if<FitExposure>(&v.exposure);
    if (!how || !is_reweighted(setup)) return exposure_of(setup, view, a, b, last);
    return fit_reweighted_exposure(*how, {a, b}, {v.image, v.mask}, last);
}

LossValue loss_of(const Setup& setup, std::size_t view, const ExposureFactors& exposure,
                  const Image& image) {
    const View& v = setup.problem.views[view];
    const auto evaluate = [&](const Image& shown) {
        return setup.problem.loss ? own_loss(setup, view, shown)
                                  : evaluate_loss(setup.options.loss, shown, v.image, v.mask);
    };
    if (exposure == kNone) return evaluate(image);
    LossValue loss = evaluate(exposed(exposure, image));
    loss.adjoint = exposed(exposure, std::move(loss.adjoint));
    return loss;
}

double loss_value_of(const Setup& setup, std::size_t view, const ExposureFactors& exposure,
                     const Image& image) {
    const View& v = setup.problem.views[view];
    const auto evaluate = [&](const Image& shown) {
        return setup.problem.loss ? own_loss(setup, view, shown).value
                                  : loss_value(setup.options.loss, shown, v.image, v.mask);
    };
    return exposure == kNone ? evaluate(image) : evaluate(exposed(exposure, image));
}

bool is_reweighted(const Setup& setup) {
    return !setup.problem.loss && setup.options.loss == Loss::kReweighted;
}

void reweigh(const Setup& setup, std::size_t view, const ExposureFactors& exposure,
             const std::vector<Image>& images, std::vector<Image>& adjoints) {
    const Image& target = setup.problem.views[view].image;
    const auto reweigh_chunk = [&](const Image& other, Image& adjoint, std::size_t i,
                                   std::size_t end) {
        for (; i < end; ++i) {
            const double j = double{exposure[i % 3] * other.values[i]},
                         g = double{target.values[i]};
            if (j > std::fabs(g))
                adjoint.values[i] *= static_cast<float>(reweighted_weight(j, g) /
                                                        square_weight(Loss::kReweighted, g));
        }
    };
    parallel_chunks(target.values.size(), kParallelFloats, [&](std::size_t i, std::size_t end) {
        reweigh_chunk(images[1], adjoints[0], i, end);
        reweigh_chunk(images[0], adjoints[1], i, end);
    });
}

double held_out_loss(const Setup& setup, std::size_t view, Image a, Image b) {
    const View& v = setup.problem.views[view];
    const ExposureFactors exposure = exposure_of(setup, view, a, b);
    if (setup.problem.loss) return loss_value_of(setup, view, exposure, mean_of(a, b));
    return loss_of_halves(setup.options.loss, exposed(exposure, std::move(a)),
                          exposed(exposure, std::move(b)), v.image, v.mask);
}

bool is_noise_known(const Setup& setup) {
    return !setup.problem.loss && is_unbiased(setup.options.loss);
}

double noise_floor(const Setup& setup, std::size_t view, const ExposureFactors& exposure,
                   const Image& a, const Image& b) {
    if (!is_noise_known(setup)) return std::numeric_limits<double>::quiet_NaN();
    // These losses are quadratic in I - G: the noise alone, put on top of the target.
    const View& v = setup.problem.views[view];
    Image noisy = v.image;
    for (std::size_t i = 0; i < noisy.values.size(); ++i)
        noisy.values[i] += 0.5f * exposure[i % 3] * (a.values[i] - b.values[i]);
    return loss_value(setup.options.loss, noisy, v.image, v.mask);
}

}  // namespace burnish
