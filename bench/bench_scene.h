// What benchmarks are asked to do: a scene, which of its textures is the target texture, and how it
// is recovered.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "experiments/target_scene.h"

namespace burnish {

struct BenchScene {
    std::string file, parameter;  ///< the parameter by its full name
    std::vector<int> size{350, 350};
    std::vector<std::string> definitions;  ///< "name=value"
};

/// SCENE PARAMETER --size W H -D name=value
void add_scene_options(CLI::App& app, BenchScene& scene);

/// Ready to be traced; the target image is left for the caller. Throws InputError: the scene cannot
/// be read or has no such parameter.
TargetScene load_target_scene(const BenchScene& scene);

/// NAME[:SHIFT], such as "pgris:identity", "mc" or "path-cache", otherwise the library's defaults.
/// Throws InputError: another name.
Estimator estimator_of(const std::string& text);

/// "texels" or "pyramid". Throws InputError: another name.
Parameterization parameterization_of(const std::string& text);

/// Of this process so far, GB.
double peak_memory_gb();

}  // namespace burnish
