// The bias of an estimator in a closed loop: experiments/closed_loop.h. One line of JSON.
//
//   burnish_closed_loop_bias SCENE.xml PARAMETER [--size 48] [--runs 32] [--iterations 30]
//                            [--init VALUE] [--set NAME=VALUE ...]
//
// From what a search finds, or from VALUE everywhere.
// NAME: an option of docs/reference/options.md. Image and texture are small, so that a texel has
// many samples: otherwise noise hides the bias.
#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "bench_scene.h"
#include "burnish/error.h"
#include "experiments/closed_loop.h"
#include "optimize/option_table.h"

using namespace burnish;

namespace {

struct CommandLine {
    std::string file, parameter;
    int size = 48;
    std::uint32_t runs = 32, iterations = 30;
    std::optional<float> init;
    std::vector<std::string> sets;
};

Options options_of(const CommandLine& line) {
    Options options;
    for (const std::string& text : line.sets) {
        const std::size_t equals = text.find('=');
        const OptionRow* row = find_option(text.substr(0, equals));
        if (!row || equals == std::string::npos)
            throw InputError("--set " + text + ": expected NAME=VALUE, NAME an option");
        set_option(*row, text.substr(equals + 1), options);
    }
    return options;
}

nlohmann::json measure(const CommandLine& line) {
    ReproduceOptions reduced;
    reduced.width = reduced.height = reduced.texture_side = line.size;
    TargetScene scene = load_target_scene({line.file, line.file, line.parameter}, reduced);
    scene.target = render_target(scene, reduced);
    const Options options = options_of(line);
    const Problem problem = problem_of(scene, line.init ? Start{*line.init} : SearchStart{});
    std::vector<LoopProducts> runs;
    for (std::uint32_t k = 0; k < line.runs; ++k)
        runs.push_back(run_closed_loop(problem, options, line.iterations, k + 1));
    const LoopBias bias = bias_of(runs);
    return {{"scene", line.file},
            {"size", line.size},
            {"init", line.init ? nlohmann::json(*line.init) : "search"},
            {"set", line.sets},
            {"iterations", line.iterations},
            {"runs", line.runs},
            {"bias", bias.bias},
            {"standard_error", bias.standard_error}};
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"The bias of an estimator in a closed loop"};
    CommandLine line;
    app.add_option("scene", line.file)->required();
    app.add_option("parameter", line.parameter, "full name")->required();
    app.add_option("--size", line.size, "of the image and the texture")->check(CLI::Range(1, 4096));
    app.add_option("--runs", line.runs)->check(CLI::Range(2, 100000));
    app.add_option("--iterations", line.iterations)->check(CLI::Range(1, 100000));
    app.add_option("--init", line.init, "everywhere; else what a search finds");
    app.add_option("--set", line.sets, "NAME=VALUE, an option of the run");
    CLI11_PARSE(app, argc, argv)
    std::cout << measure(line).dump() << "\n";
} catch (const Error& e) {
    std::cerr << "burnish_closed_loop_bias: " << e.what() << "\n";
    return 1;
}
