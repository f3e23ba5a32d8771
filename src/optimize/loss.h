// The loss between an image and its target, and the adjoint dL/dI.
#pragma once

#include "burnish/options.h"

namespace burnish {

/// Whether its derivative is affine in the image, those that reweigh apart.
bool is_unbiased(Loss loss);

/// What multiplies (I - G)^2, where the loss is a sum of squares; 0: it is not.
double square_weight(Loss loss, double g);

/// What Loss::kReweighted multiplies (I - G)^2 with: j is the image of the derivatives.
double reweighted_weight(double j, double g);

/// The weight of a channel of a pixel. mask: [height, width, 1 or 3]; empty (width 0): all ones.
inline double mask_at(const Image& mask, int x, int y, int c) {
    return mask.width == 0 ? 1.0 : double{mask.at(x, y, mask.channels == 3 ? c : 0)};
}

/// The value is averaged over pixels and channels: a mask weighs, it does not shorten the mean.
/// mask: as of mask_at. The adjoint of Loss::kReweighted is that of relMSE: see
/// reweigh.
LossValue evaluate_loss(Loss loss, const Image& image, const Image& target, const Image& mask);
/// The value alone.
double loss_value(Loss loss, const Image& image, const Image& target, const Image& mask);
/// The loss of the image that a and b, independent of each other, are noisy versions of. Where
/// is_unbiased holds their noise adds nothing on average: the residual of one times that of the
/// other, so it may be below zero. Otherwise the loss of their mean.
double loss_of_halves(Loss loss, const Image& a, const Image& b, const Image& target,
                      const Image& mask);

}  // namespace burnish
