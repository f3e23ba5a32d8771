// An estimator's derivative beside finite differences of images, in a scene of one's own.
//
// A texture is moved along a direction d, and L = sum of A I. The estimator says dL / dt as the sum
// of d and its gradient; images at two steps to either side, of the same random numbers, say it by
// central differences of fourth order. Both are means over independent batches, which give their
// standard errors.
#pragma once

#include <string>
#include <vector>

#include "gradient/mean_gradient.h"

namespace burnish {

struct CheckGradientOptions {
    Estimator estimator = MonteCarlo{};  ///< with derivatives of its own: has_own_derivatives
    /// Per pixel, of all batches together; at least kCheckBatches, rounded up to whole multiples.
    std::uint32_t samples = 256;
    std::uint32_t seed = 0;
};
inline constexpr std::uint32_t kCheckBatches = 32;
/// The step of the finite differences. Values are moved to two steps or more from 0 and 1
/// (within_steps), so that both sides can be rendered.
inline constexpr float kCheckStep = 0.005f;

/// A mean over batches.
struct CheckedMean {
    double mean = 0, standard_error = 0;
};

enum class Agreement {
    kAgree,
    kDisagree,
    /// The standard error, or the rounding of the images, is more than a quarter of the derivative,
    /// or too few batches saw samples take other paths, see kCheckDrawn: neither is shown.
    kTooNoisy,
    kNothing,  ///< both are 0, without noise: the picture shows no light that the texture scatters
};

/// One direction of one texture.
struct GradientCheck {
    std::size_t slot = 0;   ///< index into theta.textures
    std::string direction;  ///< in words
    CheckedMean estimate, difference;
    double t = 0;  ///< their difference over its standard error; infinite where that is 0
    Agreement agreement = Agreement::kTooNoisy;
};

/// |t| above this is a disagreement: of a right derivative one time in 10,000 (Student's t with
/// kCheckBatches - 1 degrees of freedom), where samples take other paths in few more than
/// kCheckDrawn batches up to one time in 900; unless they differ by less than kCheckRounding of the
/// larger one, or than the rounding of the images: these are floats, and where nothing is noisy the
/// errors of both are rounding.
inline constexpr double kCheckThreshold = 4.44, kCheckRounding = 1e-4;

/// In so many batches samples must take other paths within the steps, where the texture, or Russian
/// roulette, decides on paths: jumps that are rare and large are missing from most means of
/// differences. With fewer a disagreement is kTooNoisy; of a weight of a blend, or an opacity, an
/// agreement, too.
inline constexpr int kCheckDrawn = kCheckBatches / 2;

/// Theta with all values moved to where both sides can be rendered.
Theta within_steps(Theta theta);

/// Two directions for each texture: all of its texels together, and blocks of them up and down
/// under an adjoint whose sign changes, too. theta: within_steps. report: hears of the share that
/// is done. Throws InputError: too few samples, or an estimator without derivatives of its own.
std::vector<GradientCheck> check_gradient(const CheckGradientOptions& options,
                                          const TracedScene& view, const Theta& theta,
                                          const Progress& report = {});

}  // namespace burnish
