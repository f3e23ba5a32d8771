// burnish gradient: d(sum(A image)) / d(texture) for an adjoint image A, at the scene's own
// textures or those that --texture puts in their place.

#include <fmt/format.h>

#include "burnish/error.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/interrupt.h"
#include "cli/option_text.h"
#include "cli/progress.h"
#include "cli/scene_input.h"
#include "cli/texture_files.h"
#include "core/parallel.h"
#include "gradient/mean_gradient.h"
#include "image/files.h"
#include "optimize/option_table.h"
#include "scene/constants.h"

namespace burnish {

namespace {

struct GradientCommandOptions {
    SceneOptions scene;
    std::string parameter, adjoint, output;
    std::uint32_t samples_per_pixel = 64;
    Estimator estimator = MonteCarlo{};
    TargetFunction target_function = TargetFunction::kLuminance;
    std::vector<std::string> textures;  ///< "NAME=FILE or VALUE"
};

/// Over all estimates of the mean.
struct ContributionCounts {
    std::size_t records = 0, candidates = 0;
    std::size_t rejected = 0;  ///< contributions that were not finite
    Outlier largest;
    std::uint32_t iteration = 0;  ///< of the largest
};

void add_counts(ContributionCounts& counts, const GradientCounts& more, std::uint32_t iteration) {
    counts.records += more.records;
    counts.candidates += more.candidates;
    counts.rejected += more.rejected;
    if (more.largest.value > counts.largest.value)
        counts.largest = more.largest, counts.iteration = iteration;
}

Image read_adjoint(const std::string& file, const Film& film) {
    Image adjoint = read_radiance(file, film.crop_width, film.crop_height, "the adjoint image");
    if (adjoint.channels != 3)
        throw InputError(file + ": the adjoint image has one channel, expected three");
    return adjoint;
}

Image estimate(const GradientCommandOptions& options, const Binding& binding, const Image& adjoint,
               ContributionCounts& counts) {
    MeanGradientOptions mean{options.estimator, options.samples_per_pixel, options.scene.seed};
    if (auto* reservoirs = std::get_if<Reservoirs>(&mean.estimator))
        reservoirs->target_function = options.target_function;
    ProgressLine line("differentiating");
    const auto report = [&](const GradientCounts& more, std::uint32_t i, std::uint32_t count) {
        add_counts(counts, more, i);
        line.show_share((i + 1.0) / count);
    };
    return mean_gradient(mean, binding, adjoint, report)[0];
}

/// name: of the parameter, whose values are the only texture of theta.
void log_counts(const ContributionCounts& counts, const std::string& name, const Theta& theta,
                const Film& film) {
    log_info(fmt::format(
        "{} paths met the texture, {} derivatives; {} contributions were not finite "
        "and were left out",
        count_text(counts.records), count_text(counts.candidates), count_text(counts.rejected)));
    const Outlier& e = counts.largest;
    if (e.value == 0) return;
    const auto width = static_cast<std::uint32_t>(theta.textures[0].values.width),
               film_width = static_cast<std::uint32_t>(film.crop_width);
    log_info(fmt::format(
        "the largest contribution: {:.3g} at pixel ({}, {}) to texel ({}, {}) of {} by the {} "
        "technique in iteration {}",
        e.value, e.pixel % film_width, e.pixel / film_width, e.texel % width, e.texel / width, name,
        e.technique == Technique::kEmitter ? "emitter" : "BSDF", counts.iteration));
}

void run(const GradientCommandOptions& options) {
    if (lower_extension(options.output) != ".exr")
        throw UsageError(
            fmt::format("-o: expected a file name that ends in .exr, found '{}'", options.output));
    require_writable(options.output);
    log_without_history(options.estimator);
    const ThreadLimit threads(options.scene.threads);
    LoadedScene loaded = load_scene_with_progress(options.scene);
    replace_textures(loaded.scene, options.textures);
    const std::size_t parameter = require_parameter(loaded.scene, options.parameter);
    const Renderer renderer = make_renderer_with_progress(
        std::move(loaded), options.scene.light_selection, options.scene.sensor);
    const Image adjoint = read_adjoint(options.adjoint, renderer.data().traced.film);
    const Scene& scene = renderer.data().scene();
    const Parameter& p = scene.parameters[parameter];
    Theta theta;
    add_unknown(scene, p.name, p.texture, theta);
    ContributionCounts counts;
    const Image gradient =
        estimate(options, Binding(renderer.data().traced, theta), adjoint, counts);
    {
        const WholeStep whole;  // a signal leaves no unfinished file
        write_image(options.output, gradient);
    }
    log_counts(counts, p.name, theta, renderer.data().traced.film);
    log_info(fmt::format("{}: the derivative by {}, {} x {} texels", options.output, p.name,
                         gradient.width, gradient.height));
}

}  // namespace

void add_gradient_command(CLI::App& app) {
    auto options = std::make_shared<GradientCommandOptions>();
    CLI::App* command = app.add_subcommand(
        "gradient", "Writes the derivative of sum(A image) by each texel of a parameter");
    command
        ->add_option("--parameter", options->parameter,
                     "A texture, or a constant in its place; `burnish info` lists "
                     "them")
        ->type_name("NAME[:SIZE]")
        ->required();
    add_text(*command, "--adjoint", options->adjoint, "A.exr", "A: RGB, of the size of the film")
        ->required();
    add_text(*command, "-o,--output", options->output, "OUT.exr",
             "The derivative, of the texture's size")
        ->required();
    add_number(*command, "--spp", options->samples_per_pixel, "N", "Samples per pixel",
               {1, kMaxSamplesPerPixel, true});
    add_choice(*command, "--estimator", options->estimator, "How the derivative is estimated",
               has_own_derivatives);
    const CLI::Option* target_function =
        add_choice(*command, "--target-function", options->target_function,
                   find_option("reservoirs.target_function")->info.sentence);
    add_texture_option(*command, options->textures);
    add_render_options(*command, options->scene);
    command->callback([options, target_function] {
        if (target_function->count() > 0 && !std::holds_alternative<Reservoirs>(options->estimator))
            throw UsageError(
                "--target-function has no effect: it needs the estimator ris, pris, gris or pgris");
        run(*options);
    });
}

}  // namespace burnish
