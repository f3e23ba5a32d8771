// Burnish's side of bench/benchmarks.py and bench/compare_mitsuba.py, and the evaluation of both
// sides.
//
//   burnish_beside run SCENE PARAMETER ...          an optimisation run; the textures at moments
//   burnish_beside derivatives SCENE PARAMETER ...  derivatives after 20 iterations of pgris
//   burnish_beside textures SCENE PARAMETER ...     loss and error of each of several textures
//   burnish_beside errors SCENE PARAMETER ...       the error of each of several derivatives
//
// Each prints one line of JSON.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench_scene.h"
#include "burnish/error.h"
#include "core/median.h"
#include "experiments/trajectory.h"
#include "image/image.h"
#include "texture/coverage.h"

using namespace burnish;
using Json = nlohmann::json;
namespace fs = std::filesystem;

namespace {

struct CommandLine {
    BenchScene scene;
    std::string target, output, texture = "0.5", adjoint, estimator = "path-cache";
    std::string parameterization = "pyramid";
    std::vector<std::string> files, variants{"pgris:identity"};
    std::vector<double> moments;
    double learning_rate = 0.01, seconds = 0;
    int repeats = 3;
    std::uint32_t image_samples = 32, samples = 1, seed = 0;
    std::uint32_t evaluation_samples = 64;
};

TargetScene scene_of(const CommandLine& line) {
    TargetScene scene = load_target_scene(line.scene);
    scene.target = with_channels(read_image(line.target), 3);
    return scene;
}

/// A file, or a value for all texels.
Image read_texture(const TargetScene& scene, const std::string& text) {
    const Image& t = scene.truth;
    char* end = nullptr;
    const float value = std::strtof(text.c_str(), &end);
    if (*end == '\0') return make_image(t.width, t.height, t.channels, value);
    return with_channels(read_image(text), t.channels);
}

Estimator with_samples(Estimator estimator, const CommandLine& line) {
    const auto set = [&](auto* o) {
        if (o) o->image_samples = line.image_samples, o->samples = line.samples;
    };
    set(std::get_if<MonteCarlo>(&estimator));
    set(std::get_if<Reservoirs>(&estimator));
    return estimator;
}

Options options_of(const CommandLine& line) {
    Options options;
    options.estimator = with_samples(estimator_of(line.estimator), line);
    options.parameterization = parameterization_of(line.parameterization);
    options.loss = Loss::kRelMse;
    options.learning_rate = line.learning_rate;
    options.seed = line.seed;
    return options;
}

// ---- run

/// Counts the seconds of iterations alone; the texture of a moment is the first at or after it.
void run_to_moments(const CommandLine& line) {
    const TargetScene scene = scene_of(line);
    Solver solver(problem_of(scene), options_of(line));
    Json moments = Json::array();
    std::vector<double> iterations;
    step_for(solver, line.moments.back(), [&](double spent, const Iteration& i) {
        iterations.push_back(stage_seconds(i));
        while (moments.size() < line.moments.size() && spent >= line.moments[moments.size()]) {
            const fs::path file = fs::path(line.output) / fmt::format("{}.exr", moments.size());
            write_image(file, solver.texture(0));
            moments.push_back({{"seconds", spent},
                               {"iterations", solver.iterations()},
                               {"texture", file.string()}});
        }
    });
    if (iterations.size() > 1) iterations.erase(iterations.begin());  // gathers the background
    std::cout << Json{{"moments", moments},
                      {"iteration_s", median(iterations)},
                      {"peak_memory_gb", peak_memory_gb()}}
              << std::endl;
}

// ---- derivatives

Json repeat_derivative(const CommandLine& line, const TargetScene& scene,
                       const Trajectory& trajectory, const Estimator& estimator,
                       const std::string& name) {
    Json files = Json::array();
    std::vector<double> seconds;
    for (int k = 0; k < line.repeats; ++k) {
        const DerivativeEstimate e = estimate_along(scene.traced(), trajectory, estimator,
                                                    line.seed + 1000 + static_cast<unsigned>(k));
        const fs::path file = fs::path(line.output) / fmt::format("{}_{}.exr", name, k);
        write_image(file, e.gradient);
        files.push_back(file.string());
        seconds.push_back(e.seconds);
    }
    const std::uint32_t samples = std::visit([](const auto& o) { return o.samples; }, estimator);
    return {{"spp", samples}, {"seconds", seconds}, {"files", files}};
}

std::string file_stem(std::string variant) {
    std::replace(variant.begin(), variant.end(), ':', '_');
    return variant;
}

void differentiate_along(const CommandLine& line) {
    constexpr std::uint32_t kIterations = 20;
    const TargetScene scene = scene_of(line);
    Options paper = options_of(line);
    paper.estimator = with_samples(estimator_of("pgris:identity"), line);
    paper.parameterization = Parameterization::kTexels;
    const Trajectory trajectory = record_trajectory(scene, paper, kIterations);
    const fs::path folder = line.output;
    write_image(folder / "texture.exr", trajectory.theta.back().textures[0].values);
    write_image(folder / "adjoint.exr", trajectory.adjoint.back());
    const CostLine cost = baseline_cost(scene.traced(), trajectory, line.seed);
    Json out{{"texture", folder / "texture.exr"}, {"adjoint", folder / "adjoint.exr"}};
    out["variants"]["mc"] = repeat_derivative(
        line, scene, trajectory, baseline_estimator(affordable_samples(cost, line.seconds)), "mc");
    for (const std::string& name : line.variants)
        out["variants"][name] =
            repeat_derivative(line, scene, trajectory, estimator_of(name), file_stem(name));
    std::cout << out << std::endl;
}

// ---- evaluation

/// The loss without the noise of the image.
double loss_of(const TargetScene& scene, const Image& texture, const CommandLine& line) {
    Options options = options_of(line);
    options.parameterization = Parameterization::kTexels;  // starts at `texture` to the byte
    const Solver solver(problem_of(scene, texture), options);
    return loss_without_noise(solver.evaluate(2 * line.evaluation_samples, 1));
}

void evaluate_textures(const CommandLine& line) {
    const TargetScene scene = scene_of(line);
    const std::vector<char> visited = visited_texels(scene, line.seed);
    Json textures = Json::array();
    for (const std::string& file : line.files) {
        const Image texture = read_texture(scene, file);
        textures.push_back({{"loss", loss_of(scene, texture, line)},
                            {"texture_error", texture_error(texture, scene.truth, visited)}});
    }
    std::cout << textures << std::endl;
}

void evaluate_derivatives(const CommandLine& line) {
    const TargetScene scene = load_target_scene(line.scene);
    Trajectory at;
    at.theta.push_back({{{scene.texture, read_texture(scene, line.texture)}}});
    at.adjoint.push_back(with_channels(read_image(line.adjoint), 3));
    const DerivativeReference reference =
        converged_derivative(scene.traced(), at, line.evaluation_samples, line.seed);
    Json errors = Json::array();
    for (const std::string& file : line.files)
        errors.push_back(derivative_error(read_image(file), reference).nmse);
    std::cout << Json{{"nmse", errors}, {"reference_nmse", reference.nmse}} << std::endl;
}

// ---- command line

CLI::App& add_command(CLI::App& app, CommandLine& line, const char* name,
                      void (*run)(const CommandLine&)) {
    CLI::App* command = app.add_subcommand(name);
    add_scene_options(*command, line.scene);
    command->add_option("--seed", line.seed);
    command->callback([&line, run] { run(line); });
    return *command;
}

void add_run_options(CLI::App& app, CommandLine& line) {
    app.add_option("--target", line.target)->required();
    app.add_option("-o,--output", line.output, "folder, which exists")->required();
    app.add_option("--learning-rate", line.learning_rate);
    app.add_option("--spp", line.image_samples);
    app.add_option("--gradient-spp", line.samples);
}

void add_commands(CLI::App& app, CommandLine& line) {
    CLI::App& run = add_command(app, line, "run", run_to_moments);
    add_run_options(run, line);
    run.add_option("--estimator", line.estimator, "NAME[:SHIFT]");
    run.add_option("--parameterization", line.parameterization, "texels or pyramid");
    run.add_option("--moments", line.moments, "seconds of iterations, ascending")->required();
    CLI::App& derivatives = add_command(app, line, "derivatives", differentiate_along);
    add_run_options(derivatives, line);
    derivatives.add_option("--seconds", line.seconds, "what mc may take")->required();
    derivatives.add_option("--repeats", line.repeats);
    derivatives.add_option("--variants", line.variants, "NAME[:SHIFT]...");
    CLI::App& textures = add_command(app, line, "textures", evaluate_textures);
    textures.add_option("--target", line.target)->required();
    textures.add_option("--spp", line.evaluation_samples, "of each of two halves");
    textures.add_option("--textures", line.files)->required();
    CLI::App& errors = add_command(app, line, "errors", evaluate_derivatives);
    errors.add_option("--texture", line.texture)->required();
    errors.add_option("--adjoint", line.adjoint)->required();
    errors.add_option("--spp", line.evaluation_samples, "of the converged derivative");
    errors.add_option("--derivatives", line.files)->required();
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"Burnish's side of a comparison"};
    app.require_subcommand(1);
    CommandLine line;
    add_commands(app, line);
    CLI11_PARSE(app, argc, argv)
} catch (const Error& e) {
    std::cerr << "burnish_beside: " << e.what() << "\n";
    return 1;
}
