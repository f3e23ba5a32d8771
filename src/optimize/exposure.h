// The exposure at which an image is nearest to a picture.
//
// Of a loss that sums up w (e I - G)^2 it is e = sum of w G I / sum of w I^2. The image is known as
// two noisy ones, A and B, independent of each other: A B is I^2 on average, A^2 is not, so that
// e = sum of w G (A + B) / 2 / sum of w A B, and its noise alone, over all pixels, is left.
//
// At this e the loss does not change with e to first order, so the gradient by the textures is the
// one at a constant e. Under Loss::kReweighted the gradient is not that of the loss: textures are
// stepped at the e at which its own sum, of (e A - G) w(e B, G) B and of A and B exchanged, is 0.
#pragma once

#include "burnish/options.h"
#include "burnish/solve.h"

namespace burnish {

inline bool fits_exposure(const Exposure& exposure) {
    return std::holds_alternative<FitExposure>(exposure);
}
/// 1 where the exposure is to be fitted.
inline ExposureFactors factors_of(const Exposure& exposure) {
    const auto* factors = std::get_if<ExposureFactors>(&exposure);
    return factors ? *factors : ExposureFactors{1, 1, 1};
}

/// Versions of an image, [height, width, 3], whose noise is independent.
struct ImageHalves {
    const Image &a, &b;
};
struct WeightedPicture {
    const Image &image, &mask;  ///< as of View
};

/// Of the least loss between e I and the picture. `last` where that is not above 0: an image or a
/// picture without light.
ExposureFactors fit_exposure(const FitExposure& how, Loss loss, const ImageHalves& halves,
                             const WeightedPicture& picture, const ExposureFactors& last);
/// Where the gradient of Loss::kReweighted does not change with the exposure: of an estimator with
/// derivatives of its own, nearly so. Found in rounds from `last`, which is above 0, and is the
/// result where the image or the picture has no light.
ExposureFactors fit_reweighted_exposure(const FitExposure& how, const ImageHalves& halves,
                                        const WeightedPicture& picture,
                                        const ExposureFactors& last);

}  // namespace burnish
