// The options of `burnish optimize`: their defaults, what goes together, and what the built-in demo
// sets.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/scene_input.h"
#include "texture/coverage.h"
#include "optimize/solve.h"

namespace burnish {

/// What recovers textures best (docs/results.md): records are kept and shaded again, and
/// neighbouring texels share evidence, because single ones see too few samples.
inline SolveOptions default_solve_options() {
    SolveOptions options;
    options.gradient.estimator = Estimator::kPool;
    options.gradient.pixels = PixelChoice::kAdaptive;  // of the other estimators
    options.parameterization.kind = Parameterization::kPyramid;
    options.optimizer.kind = Optimizer::kGatedAdam;
    return options;
}

struct OptimizeOptions {
    SceneOptions scene;
    std::vector<std::string> parameters;  ///< NAME or NAME@RATE
    std::string target;                   ///< image file; empty: rendered from the scene's textures
    std::uint32_t target_samples = 512;
    std::vector<std::string>
        initial;  ///< a number, a file, or "scene": once, or once per parameter
    std::vector<double> learning_rates;  ///< once, or once per parameter; empty: the default
    SolveOptions solve = default_solve_options();
    std::optional<std::uint32_t> iterations;
    std::optional<double> seconds;
    std::uint32_t patience = 0;  ///< see Budget; 0: none
    std::optional<double> initial_rate;
    std::optional<double> max_memory;  ///< GiB, of the process; with a pool
    std::string mask;
    Unvisited unseen = Unvisited::kFill;
    std::optional<Estimator> compare;
    std::uint32_t evaluation_samples = 256;  ///< fresh samples per pixel that judge a result
    std::string output = "burnish-out";
    bool force = false;
    bool demo = false;  ///< no scene was given: the built-in one
};

/// Whether one of the descents that are asked for uses it.
inline bool uses(const OptimizeOptions& o, Estimator estimator) {
    return o.solve.gradient.estimator == estimator || o.compare == estimator;
}

/// Of a texture that is the only one of its material to be recovered.
double default_learning_rate(const OptimizeOptions& options);

/// What the process may take, bytes: max_memory, or half of the machine's.
double memory_limit(const OptimizeOptions& options);

/// Adds all options. `options` must outlive the parsing.
void add_optimize_options(CLI::App& command, OptimizeOptions& options);

/// Fills in what depends on other options, and says what has no effect or no good one. Throws
/// UsageError where options contradict each other.
void complete_optimize_options(const CLI::App& command, OptimizeOptions& options);

}  // namespace burnish
