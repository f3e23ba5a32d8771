// Which texels a picture can say anything about.
#pragma once

#include <cstdint>
#include <vector>

#include "gradient/theta.h"
#include "paths/trace.h"
#include "render/render.h"

namespace burnish {

/// What pictures say about the texels of a texture, [height, width].
struct TexelEvidence {
    /// Non-zero where light paths meet the texel on the way to the camera.
    std::vector<char> visited;
    /// The sum over the pictures' channels of weight (dI / d(texel))^2, over the texel's channels:
    /// the diagonal of the Gauss-Newton matrix. An estimate without bias, so some are below zero.
    std::vector<float> sensitivity;
};

/// Of each texture of theta. weights: [crop_height, crop_width, 3], of the squared difference of a
/// picture's channels in the loss, at least 0. passes: samples per pixel of the derivative, at
/// least 2; an even number. Two samples of the derivative of an image whose pixels have random
/// signs: the product of both is the sum of squares on average [Hutchinson 1990].
std::vector<TexelEvidence> texel_evidence(const TracedScene& scene, const Theta& theta,
                                          const Image& weights, std::uint32_t seed,
                                          std::uint32_t passes, const Progress& progress = {});

/// Adds what another picture says.
void add(const std::vector<TexelEvidence>& evidence, std::vector<TexelEvidence>& to);

/// Root mean squared difference over the visited texels and their channels; NaN where none is
/// visited. visited: [height, width].
double texture_error(const Image& texels, const Image& truth, const std::vector<char>& visited);

/// The same over all texels, each weighted with its sensitivity: what the pictures leave open does
/// not count. NaN where they do not tell anything, or the noise of the sensitivities hides it.
double weighted_texture_error(const Image& texels, const Image& truth,
                              const std::vector<float>& sensitivity);

}  // namespace burnish
