// A problem and its options, checked and resolved against the scene: what is constant for a run.
#pragma once

#include <span>
#include <vector>

#include "burnish/solve.h"
#include "gradient/theta.h"
#include "paths/trace.h"
#include "texture/pyramid.h"

namespace burnish {

/// An unknown and how it moves.
struct UnknownTexture {
    TextureId texture;
    Image start;       ///< [height, width, channels] of the bitmap
    AdamOptions adam;  ///< of all levels
    PyramidMaps maps;
};

struct Setup {
    Problem problem;
    Options options;
    const TracedScene* scene = nullptr;  ///< the renderer's
    std::vector<UnknownTexture> unknowns;
};

/// Throws InputError where options are out of range or sizes do not fit; the message says what to
/// change.
Setup make_setup(Problem problem, Options options);

/// Whether steps are multiplied with the signal-to-noise gate: see Adam::gate.
bool uses_gate(const Options& options);

/// Options::stop, with 200 iterations where it has no rule.
Stop effective_stop(const Options& options);

/// The unknowns at their start.
Theta initial_theta(const Setup& setup);

/// The learning rate of each unknown that has none of its own: the default, shared out among the
/// unknowns that one BSDF reads. Together they move the picture about as far as one of them alone.
float shared_rate(const Scene& scene, std::span<const TextureId> unknowns, TextureId texture,
                  double rate);

/// The loss of an image with its adjoint, and alone.
LossValue loss_of(const Setup& setup, const Image& image);
double loss_value_of(const Setup& setup, const Image& image);
/// The loss of the image that a and b, independent of each other, are noisy versions of, without
/// their noise where that is known: see loss_of_halves. Of a loss of your own: that of their mean.
double held_out_loss(const Setup& setup, const Image& a, const Image& b);
/// What noise of the size of (a - b) / 2 adds to the loss on average; NaN where that is not known.
double noise_floor(const Setup& setup, const Image& a, const Image& b);

}  // namespace burnish
