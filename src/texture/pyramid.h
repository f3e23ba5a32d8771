// What the optimiser moves, and the texture that follows from it. The gradient of the loss by the
// texture becomes the gradient by the parameters through the transposed map, so any of them is an
// unbiased descent on its own parameters.
#pragma once

#include <cstdint>
#include <vector>

#include "image/image.h"
#include "gradient/split_gradient.h"
#include "texture/adam.h"
#include "texture/smoothing.h"
#include "texture/prolongation.h"

namespace burnish {

enum class Parameterization {
    kTexels,   ///< every texel on its own: the paper's
    kPyramid,  ///< the texture is a sum of levels of halved resolution, upsampled: neighbouring
               ///< texels share evidence
    kSmooth,   ///< the texture is smoothed parameters: large steps [Nicolet et al. 2021]
};

struct ParameterizationOptions {
    Parameterization kind = Parameterization::kTexels;
    /// Of kPyramid, at least 1. The coarsest texel spans 2^(levels - 1) texels a side: wide enough
    /// to be hit in every iteration, narrow enough to follow the picture. All levels down to one
    /// texel let the brightest part of the image decide for all others.
    int pyramid_levels = 5;
    /// Of kSmooth, >= 0, texels: how far evidence spreads at first.
    float smoothing_length = 16;
    Upsampling upsampling = Upsampling::kBilinear;  ///< of kPyramid
    /// Of kPyramid with Adam: OptimizerOptions::decay of all levels but the coarsest. Detail that
    /// the gradient does not keep asking for goes away.
    float weight_decay = 0.5f;
    /// Of kPyramid by agreement: OptimizerOptions::snr_prior of all levels but the coarsest.
    /// Levels that are too fine for the picture hardly move.
    float snr_prior = 0.25f;
};

/// A texture as the optimiser sees it: levels[0] has the texture's size, each next one half of it
/// (rounded up).
struct LevelState {
    Image values;
    ChartBorders borders;  ///< how it reads the next coarser level
    OptimizerState optimizer;
    SplitGradient gradient;  ///< work memory of descend, kept for the next step
    Image sum;  ///< of this and all coarser levels, but of the finest; the last step of kSmooth
    DirtyBlocks unknown_inputs;  ///< where that sum has changed since `encode`
    DirtyBlocks passed;  ///< of `moving`: those of which the next finer level knows
};
struct TextureParameters {
    std::vector<LevelState> levels;
    Prolongation prolongation;         ///< of kPyramid
    TexelLinks links;            ///< of kSmooth; width 0 for the others
    float smoothing_length = 0;  ///< of kSmooth
    float weight_decay = 0;      ///< of kPyramid
    float snr_prior = 0;  ///< of kPyramid
    /// Per texel: steps for which samples had reached it, so that its gradient was not zero.
    std::vector<std::uint32_t> visits;
};

/// Parameters whose texture is `initial` exactly. charts: of its texels, [height, width], between
/// which nothing is shared; empty: one chart. repeats: whether texels at opposite borders of the
/// texture are neighbours to a pyramid. A pyramid has fewer levels where the texture is a single
/// texel before.
TextureParameters encode(const ParameterizationOptions& options, const Image& initial,
                         const ChartMap& charts = {}, bool repeats = false);

/// One descent step. texture: the one of the parameters before, becomes the one after, clamped to
/// [0, 1].
void descend(const OptimizerOptions& options, const SplitGradient& gradient,
             TextureParameters& parameters, Image& texture);

/// How far the halves of the texels' gradients agreed lately (over some 1 / (1 - beta2) steps), 0
/// to 1, [height, width, 1]: of the levels that a texel is a sum of, the one with most agreement,
/// of its channels the one with least. Width 0 where the optimiser is not Optimizer::kGatedAdam.
Image confidence(const TextureParameters& parameters);

/// The texture: the sum of the upsampled levels, clamped to [0, 1].
Image decode(const TextureParameters& parameters);

}  // namespace burnish
