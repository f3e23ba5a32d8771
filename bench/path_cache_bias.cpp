// The bias of the path cache in a closed loop: experiments/closed_loop.h. One line of JSON.
//
//   burnish_path_cache_bias SCENE.xml PARAMETER [--size 48] [--runs 32] [--iterations 30] [--spp 4]
//                           [--window 32] [--learning-rate 0.01] [--parameterization texels]
//
// Image and texture are small, so that a texel has many samples: otherwise noise hides the bias.
#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench_scene.h"
#include "burnish/error.h"
#include "experiments/closed_loop.h"

using namespace burnish;

namespace {

struct CommandLine {
    std::string file, parameter, parameterization = "texels";
    int size = 48;
    std::uint32_t runs = 32, iterations = 30;
    PathCache cache;
    double learning_rate = 0.01;
};

nlohmann::json measure(const CommandLine& line) {
    ReproduceOptions reduced;
    reduced.width = reduced.height = reduced.texture_side = line.size;
    const TargetScene scene = prepare_target_scene({line.file, line.file, line.parameter}, reduced);
    Options options;
    options.estimator = line.cache;
    options.parameterization = parameterization_of(line.parameterization);
    options.learning_rate = line.learning_rate;
    std::vector<LoopProducts> runs;
    for (std::uint32_t k = 0; k < line.runs; ++k)
        runs.push_back(run_closed_loop(problem_of(scene), options, line.iterations, k + 1));
    const LoopBias bias = bias_of(runs);
    return {{"scene", line.file},
            {"size", line.size},
            {"spp", line.cache.samples},
            {"window", line.cache.window},
            {"learning_rate", line.learning_rate},
            {"iterations", line.iterations},
            {"runs", line.runs},
            {"bias", bias.bias},
            {"standard_error", bias.standard_error}};
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"The bias of the path cache in a closed loop"};
    CommandLine line;
    app.add_option("scene", line.file)->required();
    app.add_option("parameter", line.parameter, "full name")->required();
    app.add_option("--size", line.size, "of the image and the texture")->check(CLI::Range(1, 4096));
    app.add_option("--runs", line.runs)->check(CLI::Range(2, 100000));
    app.add_option("--iterations", line.iterations)->check(CLI::Range(1, 100000));
    app.add_option("--spp", line.cache.samples);
    app.add_option("--window", line.cache.window);
    app.add_option("--learning-rate", line.learning_rate);
    app.add_option("--parameterization", line.parameterization, "texels or pyramid");
    CLI11_PARSE(app, argc, argv)
    std::cout << measure(line).dump() << "\n";
} catch (const Error& e) {
    std::cerr << "burnish_path_cache_bias: " << e.what() << "\n";
    return 1;
}
