// A scene that the experiments work on: the texture to recover, its true values, and the image that
// is to be matched.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "optimize/solve.h"
#include "mitsuba/load.h"

namespace burnish {

/// Where a subject comes from, with the settings of the paper for it.
struct SubjectSource {
    std::string name;
    std::filesystem::path file;
    std::string parameter;
    float learning_rate = 0.01f;
    float confidence_cap = 16;  ///< 32 for base colour [PR sec. 5]
};

struct ReproduceOptions {
    int width = 175, height = 175;  ///< of the image
    /// Side of the optimised texture; larger ones are averaged down, so that a small image meets as
    /// many samples per texel as a large one of a large texture. 0: the scene's.
    int texture_side = 256;
    std::uint32_t primal_samples = 32;      ///< per pixel and iteration
    std::uint32_t target_samples = 256;     ///< per pixel
    std::uint32_t reference_samples = 256;  ///< per pixel, of the converged derivative
    std::uint32_t evaluation_samples = 64;  ///< per pixel, of images that judge a descent
    std::uint32_t iterations = 20;          ///< before a derivative is looked at
    double descent_seconds = 8;             ///< of each descent of `inverse`
    double sweep_seconds = 2;               ///< of each descent of `adam`, and of parameterizations
    std::uint32_t max_samples = 64;        ///< per pixel, to which `equal-error` goes
    std::uint32_t seed = 0;
};

struct Study;

/// Heap-allocated: the parts refer to each other.
struct Subject {
    SubjectSource source;
    LoadedScene loaded;
    std::unique_ptr<TracedScene> traced;
    Problem problem;
    TextureId texture;
    Image truth;                ///< what the target was rendered from
    std::vector<char> reached;  ///< texels that light paths meet
    /// The descent whose derivatives are studied, once an experiment has asked for it.
    std::shared_ptr<const Study> study;
};

/// Loads the scene, brings its texture to size and renders the target. Throws InputError: the scene
/// cannot be read or has no such parameter.
std::unique_ptr<Subject> prepare_subject(const SubjectSource& source,
                                         const ReproduceOptions& options,
                                         const Progress& progress = {});

/// The paper's settings for a subject: plain texels, pgris, replay shift, Adam, relMSE.
SolveOptions paper_options(const Subject& subject, const ReproduceOptions& options);

/// A descent's state at its start: 0.5 everywhere.
SolveState start_gray(const Subject& subject, const SolveOptions& options);

/// Iterates until the stages have taken so many seconds. after: called when an iteration is done,
/// with the seconds so far; what it does is not counted.
void descend_for(const Subject& subject, const SolveOptions& options, double seconds,
                 SolveState& state,
                 const std::function<void(double spent, const IterationReport&)>& after = {});

/// "tire: roughness", for people.
std::string title_of(const Subject& subject);

}  // namespace burnish
