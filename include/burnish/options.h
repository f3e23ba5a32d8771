// How a problem is solved. Plain aggregates. Defaults work best on the scenes of
// docs/benchmarks.md; shift, target function, merge weights and cap of Reservoirs are the paper's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <variant>

#include "burnish/image.h"

namespace burnish {

/// How the random numbers of a pixel depend on each other from pass to pass.
enum class Sequence {
    kIndependent,  ///< not at all
    kSobol,        ///< aligned runs of 2^k passes fill the cube evenly
};

/// Detached Monte Carlo: the sum over fresh samples.
struct MonteCarlo {
    /// Per pixel of the image in an iteration, at least 1; half of them, at least 1, in each of two
    /// images for Loss::kReweighted and for a fitted exposure.
    std::uint32_t image_samples = 32;
    std::uint32_t samples = 1;  ///< per pixel of the derivative in an iteration, at least 1
    /// The derivative's samples go where pixels matter most to the gradient; otherwise as many into
    /// every pixel.
    bool adaptive_sampling = true;
    /// K: the image is that of the last passes, K at most in each of two halves, whose records are
    /// shaded again in each iteration, 2 K fresh ones at most; 0: of image_samples fresh ones
    /// alone. The derivative's samples stay independent of them.
    std::uint32_t image_window = 0;

    friend bool operator==(const MonteCarlo&, const MonteCarlo&) = default;
};

/// How a sample of an earlier iteration becomes one of this iteration.
enum class Shift {
    kReplay,    ///< the same random numbers under the current textures, traced anew [PR sec. 4.2]
    kIdentity,  ///< the same path: no ray is traced
};

/// Which signed number stands for the derivative when samples are resampled.
enum class TargetFunction {
    kLuminance,  ///< luminance of the derivative by colour channel: the paper's
    kIntegrand,  ///< the derivative itself for a scalar texture; sign(luminance) * sum of absolutes
                 ///< for RGB
};

/// How history and fresh samples share their weight.
enum class MergeRule {
    kBalance,    ///< the balance heuristic over targets [PR eq. 13]
    kDefensive,  ///< never amplifies history
};

/// Reservoirs for each texel: resampled importance sampling of the derivative.
struct Reservoirs {
    std::uint32_t image_samples = 32;  ///< as of MonteCarlo
    std::uint32_t samples = 1;         ///< m, as of MonteCarlo
    bool adaptive_sampling = true;     ///< as of MonteCarlo
    bool positivization = true;  ///< two reservoirs, one for each sign [PR eq. 11]; else one of |q|
    bool reuse = true;           ///< reservoirs of the iteration before are merged in [PR alg. 3]
    Shift shift = Shift::kReplay;  ///< with reuse
    TargetFunction target_function = TargetFunction::kLuminance;
    MergeRule merge = MergeRule::kBalance;  ///< with reuse
    /// M_cap, with reuse: history counts at most this many candidates per pixel; above 0.
    float confidence_cap = 16;
    std::uint32_t image_window = 0;  ///< as of MonteCarlo

    friend bool operator==(const Reservoirs&, const Reservoirs&) = default;
};

/// The records of the last passes, all shaded again in each iteration. Two halves of samples that
/// know nothing of each other give the image, the gradient, and most of the gradient's noise.
struct PathCache {
    /// Fresh ones per pixel in an iteration, at least 1; more than 2 K are not traced.
    std::uint32_t samples = 4;
    std::uint32_t window = 32;  ///< K: the most passes that a half keeps, at least 1
    std::size_t max_bytes = 0;  ///< that the records may take; 0: any. Shortens the window
    Sequence sequence = Sequence::kSobol;  ///< of the passes of a half

    friend bool operator==(const PathCache&, const PathCache&) = default;
};

/// How the gradient is estimated. To add one: here, its folder in src/gradient/, its name in
/// optimize/option_value.cpp, its options in optimize/option_table.cpp, and what the compiler then
/// asks for.
using Estimator = std::variant<PathCache, Reservoirs, MonteCarlo>;

/// What is minimised between an image I and its target G. An unbiased gradient needs a derivative
/// that is affine in I. To add one: here, its name in optimize/option_value.cpp, and what the
/// compiler then asks for.
enum class Loss {
    kRelMse,  ///< mean of (I - G)^2 / (G^2 + 0.01)
    kL2,      ///< mean of (I - G)^2
    kL1,  ///< mean of |I - G|; its derivative is not affine in I: a noisy image biases the gradient
    /// relMSE as iteratively reweighted least squares: its value is relMSE, its gradient that of
    /// the mean of (I - G)^2 / (max(J, |G|)^2 + 0.01) by I, where J is an image of other samples.
    /// Pixels that are too bright do not outweigh all others. J varies with its noise, but is
    /// independent of I but for a fitted exposure: where I is G on average the gradient is zero on
    /// average.
    kReweighted,
};

/// The value of a loss, and dL/dI [height, width, 3].
struct LossValue {
    double value = 0;
    Image adjoint = {};
};

/// A loss of your own: of the image [height, width, 3], linear RGB, of a view, named by its place
/// in Problem::views. It gets the whole image, times the view's exposure, and returns dL/dI of just
/// that; the view's mask counts in psnr alone: apply it in the loss. Called from one thread. What
/// it throws is thrown by the call that needs it.
using LossFunction = std::function<LossValue(const Image& image, std::size_t view)>;

/// Adam [Kingma and Ba 2015].
struct Adam {
    float beta1 = 0.9f;    ///< [0, 1): decay of the mean of gradients
    float beta2 = 0.999f;  ///< [0, 1): decay of the mean of squares
    /// Steps are multiplied with a signal-to-noise gate, Wiener's factor, where the estimator gives
    /// a split-sample gradient (PathCache). Empty: of a pyramid, of textures of several texels.
    std::optional<bool> gate = {};
    /// At least 0: the learning rate of the first ten steps, at most four times that of the others,
    /// to which it falls as 1 / step. Empty: 0.02 where `gate` is on, or empty and estimator and
    /// parameterisation have one, and the start is not searched, otherwise 0.
    std::optional<float> initial_rate = {};

    friend bool operator==(const Adam&, const Adam&) = default;
};

/// What the optimiser moves. To add one: here, its name in optimize/option_value.cpp, and what the
/// compiler then asks for.
enum class Parameterization {
    kPyramid,  ///< a sum of levels of halved resolution: neighbouring texels share evidence
    kTexels,   ///< every texel on its own: the paper's
};

struct Pyramid {
    int levels = 5;  ///< at least 1; a coarsest texel spans 2^(levels - 1) texels a side
    /// Decoupled weight decay of all levels but the coarsest towards where they started, in units
    /// of the learning rate; at least 0. Detail that the gradient does not keep asking for goes.
    float weight_decay = 0.5f;

    friend bool operator==(const Pyramid&, const Pyramid&) = default;
};

/// What becomes of texels that no sample visited.
enum class Unvisited {
    kFill,  ///< the mean of their surroundings, unless the start says more: it is an image, or
            ///< known textures guided the search for it
    kKeep,  ///< they stay as they were at the start, or as a later search has left them
};

/// Whatever comes first ends the run.
struct Stop {
    std::uint32_t iterations = std::numeric_limits<std::uint32_t>::max();  ///< at least 1
    /// Of Iteration::seconds, checked after each iteration.
    double seconds = std::numeric_limits<double>::infinity();
    /// Checks in a row, 20 iterations apart, that find the loss of held-out samples no lower than
    /// before, in at most 16 of the views, spread evenly; 0: no checks.
    std::uint32_t patience = 0;

    friend bool operator==(const Stop&, const Stop&) = default;
};

/// A number outside of its range of docs/reference/options.md is refused.
struct Options {
    Estimator estimator = {};
    Loss loss = Loss::kReweighted;
    /// Above 1e-36; shared out among the unknowns of a material. Empty: 0.005 for those whose start
    /// is searched, 0.003 where known textures guide that search, otherwise 0.01.
    std::optional<double> learning_rate = {};
    Adam adam = {};
    Parameterization parameterization = Parameterization::kPyramid;
    Pyramid pyramid = {};  ///< of Parameterization::kPyramid
    Unvisited unvisited = Unvisited::kFill;
    /// Iterations from one search for better values of regions to the next, the first after a
    /// quarter of them; 0: none but that for the start. Of textures whose start is searched and
    /// whose material has no colour or constant that is searched.
    std::uint32_t search_again = 0;
    /// Samples of the search for the start, in units of those beside a run of a minute, 1 to 4;
    /// none: by Stop::seconds.
    std::optional<double> search_effort = {};
    /// Samples per pixel, over the iterations, of the part of the image that no unknown reaches.
    std::uint32_t background_samples = 512;
    /// Views that an iteration visits, at least 1, in an order that is shuffled anew once all were
    /// visited.
    std::uint32_t batch = 1;
    std::uint32_t seed = 0;
    /// Without any rule: 200 iterations.
    Stop stop = {};
    /// Samples per pixel of the result's evaluation, at most 2^20, half of them for each of two
    /// images: an odd number loses one, 1 counts as 2. 0: a fifth as many as iterations visited
    /// each pixel, or 2^22 in all where that is more, at most 256.
    std::uint32_t evaluation_samples = 0;

    friend bool operator==(const Options&, const Options&) = default;
};

}  // namespace burnish
