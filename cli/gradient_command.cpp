// burnish gradient: d(sum(A image)) / d(texture) for an adjoint image A, at the scene's own
// textures or those that --texture puts in their place.
//
// The samples are drawn in chunks of a few passes, so that memory does not grow with --spp; the
// estimates of all chunks are averaged. One call has no iteration before it: gris and pgris are ris
// and pris here.

#include <fmt/format.h>

#include <filesystem>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/contributions.h"
#include "cli/option_text.h"
#include "scene/parameter_names.h"
#include "cli/progress.h"
#include "cli/scene_input.h"
#include "cli/texture_files.h"
#include "burnish/error.h"
#include "core/parallel.h"

namespace burnish {

namespace {

struct GradientCommandOptions {
    SceneOptions scene;
    std::string parameter, adjoint, output;
    std::uint32_t samples_per_pixel = 64;
    GradientOptions gradient;
    std::vector<std::string> textures;  ///< "NAME=FILE or VALUE"
};

/// All chunks have the same number of passes, so that the film offsets of all form one sequence.
std::uint32_t passes_per_chunk(std::uint32_t samples_per_pixel) {
    for (const std::uint32_t m : {4u, 3u, 2u})
        if (samples_per_pixel % m == 0) return m;
    return 1;
}

Image read_adjoint(const std::string& file, const Film& film) {
    Image adjoint = read_radiance(file, film.crop_width, film.crop_height, "the adjoint image");
    if (adjoint.channels != 3)
        throw InputError(file + ": the adjoint image has one channel, expected three");
    return adjoint;
}

Image estimate(const GradientCommandOptions& options, const TracedScene& traced, const Theta& theta,
               const Image& adjoint, ContributionCounts& counts) {
    GradientOptions gradient = options.gradient;
    gradient.seed = options.scene.seed;
    gradient.samples_per_pixel = passes_per_chunk(options.samples_per_pixel);
    const std::uint32_t chunks = options.samples_per_pixel / gradient.samples_per_pixel;
    Image mean = theta.textures[0].values;
    std::vector<double> sum(mean.values.size(), 0.0);
    ProgressLine line("differentiating");
    for (std::uint32_t i = 0; i < chunks; ++i) {
        const GradientResult result =
            estimate_gradient(traced, theta, adjoint, i, gradient, History{});
        accumulate(result.gradient, mean.channels, sum);
        add_counts(counts, result.counts, i);
        line.show_share((i + 1.0) / chunks);
    }
    for (std::size_t i = 0; i < sum.size(); ++i)
        mean.values[i] = static_cast<float>(sum[i] / chunks);
    return mean;
}

void say_counts(const ContributionCounts& counts, const Scene& scene, const Theta& theta) {
    log_info(fmt::format(
        "{} paths met the texture, {} derivatives; {} contributions were not finite "
        "and were left out",
        count_text(counts.records), count_text(counts.candidates), count_text(counts.rejected)));
    if (!counts.outliers.empty())
        log_info("the largest contribution: " + describe(counts.outliers.front(), scene, theta));
}

void run(const GradientCommandOptions& options) {
    if (std::filesystem::path(options.output).extension() != ".exr")
        throw UsageError(
            fmt::format("-o: expected a file name that ends in .exr, found '{}'", options.output));
    if (has_history(options.gradient.estimator))
        log_info(fmt::format("note: one call has no iteration before it: {} is {} here",
                        name_of(options.gradient.estimator),
                        options.gradient.estimator == Estimator::kPgris ? "pris" : "ris"));
    const ThreadLimit threads(options.scene.threads);
    LoadedScene loaded = load_scene_with_progress(options.scene);
    replace_textures(loaded.scene, options.textures);
    const Scene& scene = loaded.scene;
    const Parameter& p = scene.parameters[find_parameter(scene.parameters, options.parameter)];
    const Image adjoint = read_adjoint(options.adjoint, scene.film);
    const TracedScene traced = prepare_with_progress(scene, options.scene.light_selection);
    const Theta theta{{{p.texture, linear_image(std::get<Bitmap>(scene[p.texture]))}}};
    ContributionCounts counts;
    const Image gradient = estimate(options, traced, theta, adjoint, counts);
    write_image(options.output, gradient);
    say_counts(counts, scene, theta);
    log_info(fmt::format("{}: the derivative by {}, {} x {} texels", options.output, p.name,
                    gradient.width, gradient.height));
}

}  // namespace

void add_gradient_command(CLI::App& app) {
    auto options = std::make_shared<GradientCommandOptions>();
    options->gradient.estimator = Estimator::kMc;
    CLI::App* command = app.add_subcommand(
        "gradient", "Writes the derivative of sum(A image) by each texel of a parameter");
    command->add_option("--parameter", options->parameter, "The texture; `burnish info` lists them")
        ->type_name("NAME")
        ->required();
    command->add_option("--adjoint", options->adjoint, "A: RGB, of the size of the film")
        ->type_name("A.exr")
        ->required();
    command->add_option("-o,--output", options->output, "The derivative, of the texture's size")
        ->type_name("OUT.exr")
        ->required();
    command->add_option("--spp", options->samples_per_pixel, "Samples per pixel")
        ->type_name("N")
        ->check(in_range({1, 1 << 20, true}))
        ->capture_default_str();
    add_choice(*command, "--estimator", options->gradient.estimator, kGradientEstimatorNames,
               "How the derivative is estimated");
    add_choice(*command, "--target-function", options->gradient.target, kTargetNames,
               "By what samples are kept");
    add_texture_option(*command, options->textures);
    add_scene_options(*command, options->scene, true, true);
    command->callback([options] { run(*options); });
}

}  // namespace burnish
