// A scene with a target texture: the texture to recover, its true values, and the image to match.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "burnish/solve.h"
#include "render/render.h"
#include "render/renderer.h"

namespace burnish {

/// Where a target scene comes from, with the settings of the paper for it.
struct TargetSource {
    std::string name;
    std::filesystem::path file;
    std::string parameter;  ///< of the target texture, by its full name
    float learning_rate = 0.01f;
    float confidence_cap = 16;  ///< 32 for base colour [PR sec. 5]
};

/// What an optimisation run may take: it goes on until it has passed all of them.
struct Budget {
    std::uint32_t iterations = 25;
    std::uint32_t long_iterations = 25;  ///< of mc and of pgris with replay, at least as many
    double derivative_seconds = 0.2;  ///< of the derivative's stage, which is what the paper times
    double seconds = 0.8;             ///< of whole iterations
};

inline bool has_long(const Budget& budget) { return budget.long_iterations > budget.iterations; }

struct ReproduceOptions {
    int width = 175, height = 175;  ///< of the image
    /// Side of the target texture; larger ones are averaged down, so that a small image has as many
    /// samples per texel as a large one of a large texture. 0: the scene's.
    int texture_side = 256;
    /// Of an iteration's image, per pixel: fresh ones, and the passes that each half keeps, which
    /// are as many in all as the paper's 32 fresh ones.
    std::uint32_t image_samples = 2, image_window = 16;
    std::uint32_t target_samples = 256;     ///< per pixel
    std::uint32_t reference_samples = 256;  ///< per pixel, of the converged derivative
    std::uint32_t evaluation_samples = 32;  ///< per pixel, of images that evaluate a run
    std::uint32_t iterations = 20;          ///< before a derivative is evaluated
    Budget budget;                          ///< of each optimisation run of `inverse`
    double sweep_seconds = 0.5;             ///< of each run of `adam`, and of parameterizations
    std::uint32_t max_samples = 64;         ///< per pixel, to which `equal-error` goes
    std::uint32_t seed = 0;
    std::uint32_t runs = 5;  ///< with seeds of their own, behind each interval
};

/// Of run k along a trajectory: other random numbers than those that moved its textures.
inline std::uint32_t estimate_seed(const ReproduceOptions& options, std::uint32_t k = 0) {
    return options.seed + 1 + k;
}

struct Study;
struct InverseRuns;

struct TargetScene {
    TargetSource source;
    Renderer renderer;
    TextureId texture;
    Image truth;   ///< the target texture: what the target image was rendered from
    Image target;  ///< the image to match
    std::vector<char> visited = {};  ///< texels that light paths meet
    /// The trajectory whose derivatives are studied, once an experiment has asked for it.
    std::shared_ptr<const Study> study = {};
    std::shared_ptr<const InverseRuns> runs = {};  ///< that `inverse` compares, likewise

    const TracedScene& traced() const { return renderer.data().traced; }
    const Scene& scene() const { return renderer.data().scene(); }
};

/// Loads the scene and brings its texture to size; the target is empty. Throws InputError: the
/// scene cannot be read or has no such parameter.
TargetScene load_target_scene(const TargetSource& source, const ReproduceOptions& options);
/// The texels of the true texture that light paths meet in a few passes.
std::vector<char> visited_texels(const TargetScene& scene, std::uint32_t seed);
/// The image to match, from the scene's own textures.
Image render_target(const TargetScene& scene, const ReproduceOptions& options,
                    const Progress& progress = {});

/// The paper's settings: plain texels, pgris, replay shift, as many samples for every pixel, Adam,
/// relMSE.
Options paper_options(const TargetScene& scene, const ReproduceOptions& options);
/// Their estimator.
Reservoirs paper_estimator(const TargetScene& scene, const ReproduceOptions& options);
/// The baseline: Monte Carlo with as many derivative samples in every pixel.
MonteCarlo baseline_estimator(std::uint32_t samples = 1);
/// The same with the image of `options`.
MonteCarlo baseline_estimator(const ReproduceOptions& options);

/// The problem of recovering the target texture from 0.5 everywhere, or from `start`.
Problem problem_of(const TargetScene& scene, Start start = 0.5f);

/// Seconds of an iteration's stages.
inline double stage_seconds(const Iteration& i) {
    return i.image_seconds + i.derivative_seconds + i.step_seconds;
}
/// Steps until the stages have taken so many seconds. after: called after each step, with the
/// seconds so far; what it does is not counted.
void step_for(Solver& solver, double seconds,
              const std::function<void(double spent, const Iteration&)>& after = {});

/// "tire: roughness", for people.
std::string title_of(const TargetScene& scene);

}  // namespace burnish
