// The loss of a view: between its image, exposed, and its picture.
#pragma once

#include "optimize/exposure.h"
#include "optimize/setup.h"

namespace burnish {

/// The image as it meets a view's picture.
Image exposed(const ExposureFactors& exposure, Image image);

/// The exposure of a view: its own, or the one of the least loss of the image that a and b,
/// independent of each other, are noisy versions of; `last` where they hold no light.
ExposureFactors exposure_of(const Setup& setup, std::size_t view, const Image& a, const Image& b,
                            const ExposureFactors& last = {1, 1, 1});

/// The same where textures are stepped: under Loss::kReweighted by the weights of its gradient.
ExposureFactors stepped_exposure_of(const Setup& setup, std::size_t view, const Image& a,
                                    const Image& b, const ExposureFactors& last);

/// The loss of a view's image with its adjoint, and alone. The image is that before the exposure,
/// and so is the adjoint.
LossValue loss_of(const Setup& setup, std::size_t view, const ExposureFactors& exposure,
                  const Image& image);
double loss_value_of(const Setup& setup, std::size_t view, const ExposureFactors& exposure,
                     const Image& image);
/// Whether the gradient reweighs the pixels: see Loss::kReweighted.
bool is_reweighted(const Setup& setup);
/// The adjoints of two images that are independent of each other, before the exposure, each under
/// the weights of the other.
void reweigh(const Setup& setup, std::size_t view, const ExposureFactors& exposure,
             const std::vector<Image>& images, std::vector<Image>& adjoints);
/// The loss of the image that a and b, independent of each other, are noisy versions of, without
/// their noise where that is known: see loss_of_halves. Of a loss of your own: that of their mean.
double held_out_loss(const Setup& setup, std::size_t view, Image a, Image b);
/// Whether it is known what noise adds to the loss: not to l1, nor to a loss of your own.
bool is_noise_known(const Setup& setup);
/// What noise of the size of (a - b) / 2 adds to the loss on average; NaN where that is not known.
double noise_floor(const Setup& setup, std::size_t view, const ExposureFactors& exposure,
                   const Image& a, const Image& b);

}  // namespace burnish
