// What low-discrepancy numbers bring to the path cache: the variance, over independent runs, of the
// image of a half and of the gradient with Sequence::kSobol, over that with independent numbers,
// for windows of contiguous passes. One line of JSON for each window.
//
//   burnish_path_cache_variance SCENE.xml PARAMETER [--size W H] [--runs 8] [--starts 0 5 11]
//                         [--windows 8 16 32] [--seed 1] [-D name=value]...
//
// The variances of all pixels or texels are added up as they are (`image`, `gradient`), where a few
// large ones decide, and each relative to its mean square (`image_relative`, `gradient_relative`).
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench_scene.h"
#include "burnish/error.h"
#include "gradient/path_cache/path_cache.h"
#include "optimize/loss.h"
#include "variance.h"

using namespace burnish;

namespace {

constexpr std::uint32_t kTargetPasses = 32;

double total_variance_of(const Moments& m, const Moments&) { return total_variance(m); }

/// Each number's variance over its mean square, which is that of both kinds of runs: the same for
/// either.
double relative_variance(const Moments& m, const Moments& other) {
    double total = 0;
    for (std::size_t i = 0; i < m.sum.size(); ++i) {
        const double mean_square = (m.squares[i] + other.squares[i]) / (m.runs + other.runs);
        if (mean_square > 0) total += m.variance(i) / mean_square;
    }
    return total;
}

double ratio(double (*variance)(const Moments&, const Moments&),
             const std::array<Moments, 2>& of_sequence) {
    return variance(of_sequence[1], of_sequence[0]) / variance(of_sequence[0], of_sequence[1]);
}

struct Window {
    std::size_t start = 0, passes = 0;
    std::array<Moments, 2> images, gradients;  ///< of each sequence
};

/// The passes of a window.
PathCacheState part_of(const PathCacheState& all, const Window& window) {
    PathCacheState part;
    for (std::size_t h = 0; h < 2; ++h) {
        const auto& passes = all.halves[h].passes;
        const auto from = passes.begin() + static_cast<std::ptrdiff_t>(window.start);
        part.halves[h].passes = {from, from + static_cast<std::ptrdiff_t>(window.passes)};
    }
    return part;
}

/// The options of a cache that keeps every pass.
PathCache cache_of(std::size_t passes, Sequence sequence) {
    PathCache options;
    options.window = static_cast<std::uint32_t>(passes);
    options.sequence = sequence;
    return options;
}

/// Passes 0 .. passes - 1 in each half.
PathCacheState fill(const PathCacheInput& input, std::size_t passes) {
    const PathCacheWorkspace workspace =
        make_workspace(cache_of(passes, input.sequence), input.binding);
    PathCacheState state;
    for (std::size_t k = 0; k < passes; ++k)
        for (const std::size_t half : {std::size_t{0}, std::size_t{1}})
            trace_pass(input, half, workspace, state);
    return state;
}

HalfImages shade_part(const PathCacheInput& input, const PathCacheState& part,
                      PathCacheWorkspace& workspace) {
    workspace =
        make_workspace(cache_of(part.halves[0].passes.size(), input.sequence), input.binding);
    return shade(input, part, workspace);
}

void measure(const PathCacheInput& input, const PathCacheState& all, const Image& target,
             Window& window) {
    const PathCacheState part = part_of(all, window);
    PathCacheWorkspace workspace;
    const auto images = shade_part(input, part, workspace).images;
    std::array<Image, 2> adjoints;
    for (std::size_t h = 0; h < 2; ++h)
        adjoints[h] = evaluate_loss(Loss::kRelMse, images[h], target, {}).adjoint;
    const auto sequence = static_cast<std::size_t>(input.sequence);
    window.images[sequence].add(images[0].values);
    const auto& gradient = accumulate(input, part, {&adjoints[0], &adjoints[1]}, workspace);
    window.gradients[sequence].add(sum_of(gradient[0]).values);
}

struct CommandLine {
    BenchScene scene;
    std::vector<std::size_t> starts{0, 5, 11}, sizes{8, 16, 32};
    std::uint32_t runs = 8, seed = 1;
};

Image target_of(const TargetScene& scene, std::uint32_t seed) {
    const Theta truth{{{scene.texture, scene.truth}}};
    const Binding binding(scene.traced(), truth);
    const PathCacheInput input{binding, seed};
    PathCacheWorkspace workspace;
    return shade_part(input, fill(input, kTargetPasses), workspace).images[0];
}

std::vector<Window> measure_windows(const CommandLine& line) {
    const TargetScene scene = load_target_scene(line.scene);
    const Image target = target_of(scene, line.seed + 1000000);
    const Image& t = scene.truth;
    const Theta theta{{{scene.texture, make_image(t.width, t.height, t.channels, 0.5f)}}};
    const Binding binding(scene.traced(), theta);
    std::vector<Window> windows;
    for (const std::size_t start : line.starts)
        for (const std::size_t passes : line.sizes) windows.push_back({start, passes, {}, {}});
    const std::size_t longest = *std::max_element(line.starts.begin(), line.starts.end()) +
                                *std::max_element(line.sizes.begin(), line.sizes.end());
    for (std::uint32_t run = 0; run < line.runs; ++run)
        for (const Sequence sequence : {Sequence::kIndependent, Sequence::kSobol}) {
            const PathCacheInput input{binding, line.seed + run, sequence};
            const PathCacheState all = fill(input, longest);
            for (Window& window : windows) measure(input, all, target, window);
        }
    return windows;
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"Variance of the path cache: low-discrepancy over independent numbers"};
    CommandLine line;
    add_scene_options(app, line.scene);
    app.add_option("--runs", line.runs)->check(CLI::Range(2u, 100000u));
    app.add_option("--starts", line.starts, "first passes of the windows");
    app.add_option("--windows", line.sizes, "their numbers of passes");
    app.add_option("--seed", line.seed);
    CLI11_PARSE(app, argc, argv)
    for (const auto& [start, passes, images, gradients] : measure_windows(line))
        std::cout << nlohmann::json{{"scene", line.scene.file},
                                    {"first_pass", start},
                                    {"window", passes},
                                    {"runs", line.runs},
                                    {"image", ratio(total_variance_of, images)},
                                    {"image_relative", ratio(relative_variance, images)},
                                    {"gradient", ratio(total_variance_of, gradients)},
                                    {"gradient_relative", ratio(relative_variance, gradients)}}
                         .dump()
                  << "\n";
} catch (const Error& e) {
    std::cerr << "burnish_path_cache_variance: " << e.what() << "\n";
    return 1;
}
