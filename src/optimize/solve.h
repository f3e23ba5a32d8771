// The descent: image -> loss -> gradient -> step, one iteration at a time.
#pragma once

#include <span>
#include <vector>

#include "gradient/reservoirs/reservoirs.h"
#include "optimize/loss.h"
#include "texture/pyramid.h"
#include "gradient/path_cache/path_cache.h"
#include "render/render.h"

namespace burnish {

/// What is to be matched. Everything must outlive the descent.
struct Problem {
    const TracedScene* scene = nullptr;
    Image target;  ///< [crop_height, crop_width, 3], linear RGB radiance
    Image mask;    ///< weights, same size, 1 or 3 channels; width 0: all ones
};

/// Of Estimator::kPool.
struct PoolOptions {
    std::uint32_t samples_per_pixel = 4;   ///< fresh ones of an iteration, at least 1
    std::uint32_t window = 32;             ///< K: the most passes that a bank keeps, at least 1
    std::size_t memory = 0;                ///< bytes that the records may take; 0: any
    Sequence sequence = Sequence::kSobol;  ///< of the passes of a bank
};

struct SolveOptions {
    std::uint32_t samples_per_pixel = 32;  ///< of the primal image, each iteration; at least 1
    /// Samples per pixel gathered, over the iterations, for the part of the image that no optimised
    /// texture reaches.
    std::uint32_t static_samples_per_pixel = 512;
    GradientOptions gradient;
    PoolOptions pool;
    Loss loss = Loss::kRelMse;
    OptimizerOptions optimizer;
    ParameterizationOptions parameterization;
    std::uint32_t seed = 0;
};

/// All that survives an iteration: values only, so that a run can be stored and resumed.
struct SolveState {
    Theta theta;
    std::vector<TextureParameters> parameters;  ///< parallel to theta.textures
    std::vector<float> learning_rates;          ///< parallel to theta.textures
    History history;                            ///< where has_state(options.gradient) holds
    Pool pool;                                  ///< of Estimator::kPool
    Image static_image;                         ///< mean of the passes so far
    std::vector<std::uint32_t> static_counts;   ///< of each pixel: passes in its mean
    std::uint32_t static_passes = 0;            ///< made so far, over some or all pixels
    std::uint32_t iteration = 0;
};

/// One optimised texture, to start from.
struct InitialTexture {
    TextureId texture;
    Image values;  ///< [height, width, channels] of the bitmap
    float learning_rate = 0.01f;
    ChartMap charts = {};  ///< of its texels, see encode
    bool repeats = false;  ///< see encode
};

/// With what a parameterization has to know of the scene: the charts, where texels share evidence,
/// and whether the texture repeats.
InitialTexture initial_texture(const Scene& scene, Parameterization kind, TextureId texture,
                               Image values, float learning_rate);

SolveState start(const SolveOptions& options, const std::vector<InitialTexture>& textures);

struct IterationReport {
    std::uint32_t iteration = 0;
    double loss = 0;  ///< of this iteration's noisy image: above that of a converged one
    double image_seconds = 0, derivative_seconds = 0, step_seconds = 0;
    std::size_t rejected_image = 0;  ///< draws of the image that were not finite
    GradientCounts counts;
};

/// Throws InputError where options or sizes do not fit; the message says what to change.
void validate(const Problem& problem, const SolveOptions& options);

/// The first half of an iteration: the image of the state's textures, with its loss and adjoint.
/// Gathers a share of the static part into the state.
struct PrimalPass {
    Image image;
    LossValue loss;
    std::size_t rejected = 0;  ///< draws that were not finite
};
PrimalPass primal_pass(const Problem& problem, const SolveOptions& options, SolveState& state);

/// Takes passes of the static part, given as their mean, into state.static_image. only: non-zero
/// where the passes have sampled a pixel in full, one per pixel; empty: everywhere.
void add_static_passes(const Image& mean, std::uint32_t passes, std::span<const char> only,
                       SolveState& state);

/// The last part of an iteration: one step of the optimiser per texture. gradient: parallel to
/// state.theta.textures.
void take_step(const SolveOptions& options, const std::vector<SplitGradient>& gradient,
               SolveState& state);

/// Advances the state by one iteration. The image and the derivative use independent random streams
/// [PR sec. 2.2].
IterationReport iterate(const Problem& problem, const SolveOptions& options, SolveState& state);

/// The loss of theta with fresh samples of the evaluation stream; `salt` tells evaluations apart.
struct Evaluation {
    double loss = 0;
    Image image;
};
Evaluation evaluate(const Problem& problem, const SolveOptions& options, const Theta& theta,
                    std::uint32_t samples_per_pixel, std::uint32_t salt,
                    const Progress& progress = {});

}  // namespace burnish
