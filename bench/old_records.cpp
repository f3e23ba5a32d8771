// What the path cache's records are worth where textures have moved since they were traced: image
// and gradient at the true texture, of records whose BSDFs were sampled under another one, beside
// those of records that were sampled under the truth. One line of JSON for each of these textures.
//
//   burnish_old_records SCENE.xml PARAMETER [--size W H] [--runs 64] [--passes 8]
//                       [--shifts -0.1 -0.03 0.03 0.1] [--seed 1] [-D name=value]...
//
// The textures are the truth, moved by a number everywhere and kept within [0, 1], and 0.5
// everywhere. `image` and `gradient`: the variance over the runs, old over fresh, added up over
// pixels or texels (`sum`), and the median of them; `bias`: how far the old gradient lies from a
// fresh one, along it and relative to it, as in experiments/closed_loop.h.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench_scene.h"
#include "burnish/error.h"
#include "core/median.h"
#include "experiments/closed_loop.h"
#include "gradient/path_cache/path_cache.h"
#include "image/image.h"
#include "optimize/loss.h"
#include "variance.h"

using namespace burnish;

namespace {

constexpr std::uint32_t kTargetPasses = 256;

struct CommandLine {
    BenchScene scene;
    std::vector<float> shifts{-0.1f, -0.03f, 0.03f, 0.1f};
    std::uint32_t runs = 64, passes = 8, seed = 1;
};

struct Measured {
    Image image;     ///< of a half
    Image gradient;  ///< [texels]
};

/// Records that are traced under one texture and shaded under another, the truth.
struct Experiment {
    const TargetScene& scene;
    std::uint32_t passes;  ///< in each half
    Image target = {};

    Theta theta_of(const Image& texture) const { return {{{scene.texture, texture}}}; }
    Measured measure(const Image& sampled_under, std::uint32_t seed) const {
        PathCache options;
        options.window = passes;
        const Theta theta_of_sampling = theta_of(sampled_under), theta = theta_of(scene.truth);
        const Binding of_sampling(scene.traced(), theta_of_sampling), now(scene.traced(), theta);
        PathCacheWorkspace workspace = make_workspace(options, of_sampling);
        PathCacheState state;
        trace_passes({of_sampling, seed}, 2 * passes, workspace, state);
        workspace = make_workspace(options, now);
        const PathCacheInput input{now, seed};
        const std::array<Image, 2> images = shade(input, state, workspace).images;
        if (target.width == 0) return {mean_of(images[0], images[1]), {}};
        std::array<Image, 2> adjoints;
        for (std::size_t h = 0; h < 2; ++h)
            adjoints[h] = evaluate_loss(Loss::kRelMse, images[h], target, {}).adjoint;
        const auto& gradient = accumulate(input, state, {&adjoints[0], &adjoints[1]}, workspace);
        return {images[0], sum_of(gradient[0])};
    }
};

Image moved(Image texture, float shift) {
    for (float& v : texture.values) v = std::clamp(v + shift, 0.0f, 1.0f);
    return texture;
}

/// The target is one and a half times as bright: at the truth itself there is no gradient.
Image brightened(Image image) {
    for (float& v : image.values) v *= 1.5f;
    return image;
}

/// Independent of those with another first seed by the number of runs or more.
std::vector<Measured> measure_runs(const Experiment& experiment, const Image& sampled_under,
                                   const CommandLine& line, std::uint32_t first_seed) {
    std::vector<Measured> runs;
    for (std::uint32_t run = 0; run < line.runs; ++run)
        runs.push_back(experiment.measure(sampled_under, first_seed + run));
    return runs;
}

Moments moments_of(const std::vector<Measured>& runs, Image Measured::*part) {
    Moments moments;
    for (const Measured& run : runs) moments.add((run.*part).values);
    return moments;
}

/// Of the ratios of the variances of each pixel or texel that has one.
double median_ratio(const Moments& old, const Moments& fresh) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < fresh.sum.size(); ++i)
        if (fresh.variance(i) > 0) ratios.push_back(old.variance(i) / fresh.variance(i));
    return median(std::move(ratios));
}

/// a, b: fresh ones, independent of each other and of the old ones.
nlohmann::json compare(const std::vector<Measured>& old, const std::vector<Measured>& a,
                       const std::vector<Measured>& b) {
    std::vector<LoopProducts> products;
    for (std::size_t run = 0; run < old.size(); ++run) {
        const double norm = dot(a[run].gradient, b[run].gradient);
        products.push_back({dot(old[run].gradient, b[run].gradient) - norm, norm});
    }
    const LoopBias bias = bias_of(products);
    nlohmann::json json{{"bias", bias.bias}, {"standard_error", bias.standard_error}};
    for (const auto& [name, part] :
         {std::pair{"image", &Measured::image}, {"gradient", &Measured::gradient}}) {
        const Moments o = moments_of(old, part), f = moments_of(a, part);
        json[name] = {{"sum", total_variance(o) / total_variance(f)},
                      {"median", median_ratio(o, f)}};
    }
    return json;
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"The path cache's records after textures have moved"};
    CommandLine line;
    add_scene_options(app, line.scene);
    app.add_option("--runs", line.runs)->check(CLI::Range(2u, 100000u));
    app.add_option("--passes", line.passes, "in each half")->check(CLI::Range(1u, 1000u));
    app.add_option("--shifts", line.shifts);
    app.add_option("--seed", line.seed);
    CLI11_PARSE(app, argc, argv)
    const TargetScene scene = load_target_scene(line.scene);
    Experiment experiment{scene, kTargetPasses / 2};
    experiment.target = brightened(experiment.measure(scene.truth, line.seed + 1000000).image);
    experiment.passes = line.passes;
    const std::vector<Measured> a = measure_runs(experiment, scene.truth, line, line.seed),
                                b = measure_runs(experiment, scene.truth, line,
                                                 line.seed + line.runs);
    const auto print = [&](const nlohmann::json& sampled_under, const Image& texture) {
        nlohmann::json found =
            compare(measure_runs(experiment, texture, line, line.seed + 2 * line.runs), a, b);
        found["scene"] = line.scene.file, found["sampled_under"] = sampled_under;
        std::cout << found.dump() << std::endl;
    };
    for (const float shift : line.shifts) print({{"shift", shift}}, moved(scene.truth, shift));
    const Image& t = scene.truth;
    print({{"constant", 0.5}}, make_image(t.width, t.height, t.channels, 0.5f));
} catch (const Error& e) {
    std::cerr << "burnish_old_records: " << e.what() << "\n";
    return 1;
}
