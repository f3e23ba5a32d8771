// What a run renders beside its iterations, with fresh samples: checks of patience, and at the end
// its start and its result. Each view is rendered by the process that owns it, or by all together:
// see renders_together. Then all make the same calls.
#pragma once

#include "optimize/setup.h"
#include "optimize/state.h"
#include "render/render.h"

namespace burnish {

/// Names samples of an evaluation: two halves, independent of each other. salt tells evaluations
/// apart.
struct EvaluationKey {
    std::uint32_t salt = 0, half = 0;
};

/// What tells how a texture came out: not 0 where it is compared.
struct Compared {
    std::vector<char> pixels;  ///< those that see a texture of theta and count in the mask
    std::vector<char> values;  ///< of these pixels, [height, width, 3]: those that count
};
/// scene: of the view.
Compared compared_in(const TracedScene& scene, const Theta& theta, const Image& mask);

/// The image of theta in a view, from so many fresh samples per pixel. counts: of what this process
/// has rendered of it.
Image evaluation_image(const Setup& setup, std::size_t view, const Theta& theta, EvaluationKey key,
                       std::uint32_t passes, RenderCounts* counts = nullptr,
                       const Progress& progress = {});

/// Of all views. samples_per_pixel: 2 to kMaxSamplesPerPixel; throws InputError for others. The
/// first process has all images, the others those of their own views.
Evaluation evaluate(const Setup& setup, const Theta& theta, std::uint32_t samples_per_pixel,
                    std::uint32_t salt, const Progress& progress = {});

/// Of a result, per pixel, where no number is asked for: 2 to 256. It follows from the work alone,
/// so that it is the same on every machine: a fifth of a sample for each pixel that an iteration
/// visited, which takes about a tenth of the run, or 2^22 in all, a second or a few, where these
/// are more. visited: pixels of all iterations. pixels: of all views; at least 1.
std::uint32_t result_samples(double visited, double pixels);

/// Of the result of so many iterations, per pixel: as many as are asked for, at least 2, or those.
std::uint32_t result_samples(const Setup& setup, std::size_t iterations);

/// Of the result. samples: of result_samples.
Evaluation evaluate_result(const Setup& setup, const Theta& theta, std::uint32_t samples,
                           const Progress& progress);

/// The loss of textures without noise on average, with the same samples each time, so that most of
/// their noise is no difference between two times. Of many views it looks at those of
/// searched_views.
double check_loss(const Setup& setup, const Theta& theta);

/// Of the start of so many views, per pixel, where it is known what noise adds to the loss: all
/// together as many as eight views take with eight each, at least two for each. Where the views
/// have few pixels, more: 2^20 in all, up to 64 per pixel. pixels: of all views; at least 1.
std::uint32_t start_samples(std::size_t views, double pixels);

/// Of the start. of_result: the samples of the result, which the start has, too, where it is not
/// known what noise adds to the loss: then the noise of equally many is in both.
Evaluation evaluate_start(const Setup& setup, const Theta& start, std::uint32_t of_result,
                          const Progress& progress);

}  // namespace burnish
