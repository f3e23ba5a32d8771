// Burnish's side of bench/compare_mitsuba.py, and the judge of both sides.
//
//   burnish_beside descent SCENE PARAMETER ...      a descent; the textures at given moments
//   burnish_beside derivatives SCENE PARAMETER ...  derivatives after 20 iterations of a descent
//   burnish_beside losses SCENE PARAMETER ...       the loss of each of several textures
//   burnish_beside errors SCENE PARAMETER ...       the error of each of several derivatives
//
// Each prints one line of JSON.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "cli/option_text.h"
#include "cli/texture_files.h"
#include "burnish/error.h"
#include "core/median.h"
#include "image/image.h"
#include "experiments/trajectory.h"
#include "bench_scene.h"

using namespace burnish;
using Json = nlohmann::json;
namespace fs = std::filesystem;

namespace {

struct Options {
    BenchScene scene;
    std::string target, output, texture = "0.5", adjoint;
    std::vector<std::string> files, variants{"pgris:identity"};
    std::vector<double> moments;
    SolveOptions solve;
    double seconds = 0;
    int repeats = 3;
    std::uint32_t samples_per_pixel = 64;
};

const Bitmap& bitmap_of(const Subject& subject) {
    return std::get<Bitmap>(subject.loaded.scene[subject.texture]);
}

std::unique_ptr<Subject> subject_of(const Options& o) {
    auto subject = load_subject(o.scene);
    subject->problem.target =
        as_rgb(read_radiance(o.target, o.scene.size[0], o.scene.size[1], "the target"));
    return subject;
}

Theta theta_of(const Subject& subject, const std::string& texture) {
    return {{{subject.texture, read_texels(bitmap_of(subject), texture, "the texture")}}};
}

// ---- descent

/// Counts the seconds of iterations alone; the texture of a moment is the first at or after it.
void descend_to_moments(const Options& o) {
    const auto subject = subject_of(o);
    SolveState state = start_gray(*subject, o.solve);
    Json moments = Json::array();
    std::vector<double> iterations;
    double spent = 0;
    while (moments.size() < o.moments.size()) {
        const IterationReport r = iterate(subject->problem, o.solve, state);
        iterations.push_back(r.image_seconds + r.derivative_seconds + r.step_seconds);
        spent += iterations.back();
        while (moments.size() < o.moments.size() && spent >= o.moments[moments.size()]) {
            const fs::path file = fs::path(o.output) / fmt::format("{}.exr", moments.size());
            write_image(file, state.theta.textures[0].values);
            moments.push_back(
                {{"seconds", spent}, {"iterations", state.iteration}, {"texture", file.string()}});
        }
    }
    if (iterations.size() > 1) iterations.erase(iterations.begin());  // gathers the static image
    std::cout << Json{{"moments", moments},
                      {"iteration_s", median(iterations)},
                      {"peak_memory_gb", peak_memory_gb()}}
              << std::endl;
}

// ---- derivatives

Json repeat_derivative(const Options& o, const Subject& subject, const Trajectory& trajectory,
                       GradientOptions options, const std::string& name) {
    Json files = Json::array();
    std::vector<double> seconds;
    for (int k = 0; k < o.repeats; ++k) {
        options.seed = o.solve.seed + 1000 + static_cast<std::uint32_t>(k);
        const DerivativeEstimate e =
            options.estimator == Estimator::kPool
                ? estimate_pool_along(*subject.traced, trajectory, o.solve.pool, options.seed)
                : estimate_along(*subject.traced, trajectory, options);
        const fs::path file = fs::path(o.output) / fmt::format("{}_{}.exr", name, k);
        write_image(file, e.gradient);
        files.push_back(file.string());
        seconds.push_back(e.seconds);
    }
    return {{"spp", options.samples_per_pixel}, {"seconds", seconds}, {"files", files}};
}

std::string file_stem(std::string variant) {
    std::replace(variant.begin(), variant.end(), ':', '_');
    return variant;
}

void differentiate_along(const Options& o) {
    const auto subject = subject_of(o);
    SolveOptions solve = o.solve;
    solve.gradient.seed = solve.seed;
    const Trajectory trajectory = record_trajectory(*subject, ReproduceOptions{}, solve);
    const fs::path folder = o.output;
    write_image(folder / "texture.exr", trajectory.theta.back().textures[0].values);
    write_image(folder / "adjoint.exr", trajectory.adjoint.back());
    GradientOptions mc = o.solve.gradient;
    mc.estimator = Estimator::kMc;
    const CostLine cost = baseline_cost(*subject, trajectory, mc);
    mc.samples_per_pixel = affordable_samples(cost, o.seconds);
    Json out{{"texture", folder / "texture.exr"}, {"adjoint", folder / "adjoint.exr"}};
    out["variants"]["mc"] = repeat_derivative(o, *subject, trajectory, mc, "mc");
    for (const std::string& name : o.variants)
        out["variants"][name] = repeat_derivative(
            o, *subject, trajectory, variant_of(name, o.solve.gradient), file_stem(name));
    std::cout << out << std::endl;
}

// ---- judgement

/// relMSE without the noise of the image: the product of the differences of two independent halves.
double unbiased_loss(const Image& a, const Image& b, const Image& target) {
    double sum = 0;
    for (std::size_t i = 0; i < target.values.size(); ++i) {
        const double t = double{target.values[i]};
        sum += (double{a.values[i]} - t) * (double{b.values[i]} - t) / (t * t + 0.01);
    }
    return sum / static_cast<double>(target.values.size());
}

void judge_textures(const Options& o) {
    const auto subject = subject_of(o);
    Json losses = Json::array();
    for (const std::string& file : o.files) {
        const Theta theta = theta_of(*subject, file);
        const auto half = [&](std::uint32_t salt) {
            return evaluate(subject->problem, o.solve, theta, o.samples_per_pixel, salt).image;
        };
        losses.push_back(unbiased_loss(half(1), half(2), subject->problem.target));
    }
    std::cout << losses << std::endl;
}

void judge_derivatives(const Options& o) {
    const auto subject = load_subject(o.scene);
    Trajectory at;
    at.theta.push_back(theta_of(*subject, o.texture));
    at.adjoint.push_back(
        as_rgb(read_radiance(o.adjoint, o.scene.size[0], o.scene.size[1], "the adjoint")));
    const DerivativeReference reference =
        converged_derivative(*subject, at, o.samples_per_pixel, o.solve.seed);
    // The reference's own noise is in the sum of squared differences, and in that of its squares.
    const double noise = reference.nmse;
    Json errors = Json::array();
    for (const std::string& file : o.files) {
        const double nmse = derivative_error(read_image_file(file).image, reference.gradient).nmse;
        errors.push_back(nmse * (1 + noise) - noise);
    }
    std::cout << Json{{"nmse", errors}, {"reference_nmse", reference.nmse}} << std::endl;
}

// ---- command line

CLI::App* add_command(CLI::App& app, Options& o, const char* name, void (*run)(const Options&)) {
    CLI::App* command = app.add_subcommand(name);
    add_scene_options(*command, o.scene);
    command->add_option("--seed", o.solve.seed);
    command->callback([&o, run] { run(o); });
    return command;
}

void add_solve_options(CLI::App& app, Options& o) {
    app.add_option("--target", o.target)->required();
    app.add_option("-o,--output", o.output, "folder, which exists")->required();
    app.add_option("--learning-rate", o.solve.optimizer.learning_rate);
    app.add_option("--spp", o.solve.samples_per_pixel);
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"Burnish's side of a comparison"};
    app.require_subcommand(1);
    Options o;
    o.solve.gradient.shift = Shift::kIdentity;
    CLI::App* descent = add_command(app, o, "descent", descend_to_moments);
    add_solve_options(*descent, o);
    descent->add_option("--moments", o.moments, "seconds of iterations")->required();
    descent->add_option("--gradient-spp", o.solve.gradient.samples_per_pixel);
    add_choice(*descent, "--estimator", o.solve.gradient.estimator, kEstimatorNames, "");
    add_choice(*descent, "--shift", o.solve.gradient.shift, kShiftNames, "");
    add_choice(*descent, "--parameterization", o.solve.parameterization.kind,
               kParameterizationNames, "");
    CLI::App* derivatives = add_command(app, o, "derivatives", differentiate_along);
    add_solve_options(*derivatives, o);
    derivatives->add_option("--seconds", o.seconds, "what mc may take")->required();
    derivatives->add_option("--repeats", o.repeats);
    derivatives->add_option("--variants", o.variants, "ESTIMATOR[:SHIFT]...");
    CLI::App* losses = add_command(app, o, "losses", judge_textures);
    losses->add_option("--target", o.target)->required();
    losses->add_option("--spp", o.samples_per_pixel, "of each of two halves");
    losses->add_option("--textures", o.files)->required();
    CLI::App* errors = add_command(app, o, "errors", judge_derivatives);
    errors->add_option("--texture", o.texture)->required();
    errors->add_option("--adjoint", o.adjoint)->required();
    errors->add_option("--spp", o.samples_per_pixel, "of the converged derivative");
    errors->add_option("--derivatives", o.files)->required();
    CLI11_PARSE(app, argc, argv)
} catch (const InputError& e) {
    std::cerr << "burnish_beside: " << e.what() << "\n";
    return 1;
}
