// What benchmarks are asked to do: a scene, which of its textures is recovered, and how.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "experiments/subject.h"

namespace burnish {

struct BenchScene {
    std::string file, parameter;  ///< the parameter by its full name
    std::vector<int> size{350, 350};
    std::vector<std::string> definitions;  ///< "name=value"
};

/// SCENE PARAMETER --size W H -D name=value
void add_scene_options(CLI::App& app, BenchScene& scene);

/// Loaded and prepared; `problem.target` is left for the caller. Throws InputError: the scene
/// cannot be read or has no such parameter.
std::unique_ptr<Subject> load_subject(const BenchScene& scene);

/// ESTIMATOR[:SHIFT], such as "pgris:identity" or "mc", put into options. Throws InputError:
/// another name.
GradientOptions variant_of(const std::string& text, GradientOptions options);

/// Of this process so far, GB.
double peak_memory_gb();

}  // namespace burnish
