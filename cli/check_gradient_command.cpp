// burnish check-gradient: the derivatives by parameters of a scene beside finite differences of its
// images.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/failures.h"
#include "cli/option_text.h"
#include "cli/progress.h"
#include "cli/scene_input.h"
#include "core/parallel.h"
#include "gradient/check_gradient.h"
#include "gradient/theta.h"
#include "scene/constants.h"
#include "scene/parameter_names.h"

namespace burnish {

namespace {

struct CheckGradientCommandOptions {
    SceneOptions scene;
    std::vector<std::string> parameters;
    CheckGradientOptions check;
    std::vector<std::string> textures;  ///< "NAME=FILE or VALUE"
};

const char* verdict(Agreement agreement) {
    switch (agreement) {
        case Agreement::kAgree:
            return "agree";
        case Agreement::kDisagree:
            return "DISAGREE";
        case Agreement::kTooNoisy:
            return "too noisy to tell";
        case Agreement::kNothing:
            return "no light to compare";
    }
    return "";
}

std::string table_of(const std::vector<GradientCheck>& checks,
                     const std::vector<std::string>& names) {
    const auto text = [](const CheckedMean& m) {
        return fmt::format("{:.4g} +- {:.2g}", m.mean, m.standard_error);
    };
    std::string table;
    std::size_t last = names.size();
    for (const GradientCheck& c : checks) {
        if (c.slot != last) table += printable(names[c.slot]) + "\n";
        last = c.slot;
        table += fmt::format("  {:<20} estimator {:<18} finite differences {:<18} t {:>6.2f}  {}\n",
                             c.direction, text(c.estimate), text(c.difference), c.t,
                             verdict(c.agreement));
    }
    return table;
}

bool any_is(const std::vector<GradientCheck>& checks, Agreement agreement) {
    return std::any_of(checks.begin(), checks.end(),
                       [&](const GradientCheck& c) { return c.agreement == agreement; });
}

void run(const CheckGradientCommandOptions& options) {
    log_without_history(options.check.estimator);
    const ThreadLimit threads(options.scene.threads);
    LoadedScene loaded = load_scene_with_progress(options.scene);
    replace_textures(loaded.scene, options.textures);
    std::vector<std::size_t> parameters;
    for (const std::string& name : options.parameters)
        parameters.push_back(require_parameter(loaded.scene, name));
    const Renderer renderer = make_renderer_with_progress(
        std::move(loaded), options.scene.light_selection, options.scene.sensor);
    const Scene& scene = renderer.data().scene();
    std::vector<std::string> names;
    std::vector<TextureId> textures;
    for (const std::size_t i : parameters) {
        names.push_back(scene.parameters[i].name);
        textures.push_back(scene.parameters[i].texture);
    }
    require_distinct(options.parameters, textures);
    Theta theta;
    for (std::size_t i = 0; i < names.size(); ++i) add_unknown(scene, names[i], textures[i], theta);
    std::vector<GradientCheck> checks;
    {
        ProgressLine line("comparing");
        checks = check_gradient(options.check, renderer.data().traced, within_steps(theta),
                                progress_of(line));
    }
    const std::string table = table_of(checks, names);
    if (any_is(checks, Agreement::kDisagree)) {
        std::fputs(table.c_str(), stdout);
        std::fflush(stdout);  // a table that does not arrive hides nothing
        throw std::runtime_error(
            "the derivative disagrees with finite differences: of a right one this happens once in "
            "10,000 comparisons; try another --seed, and report the scene where it stays");
    }
    print(table);
    if (any_is(checks, Agreement::kTooNoisy))
        log_info(
            "too noisy to tell: raise --spp, by 4 for half the noise; where samples seldom take "
            "other paths, by more");
    if (any_is(checks, Agreement::kNothing))
        log_warning("no light to compare: the picture shows none that the texture scatters");
}

}  // namespace

void add_check_gradient_command(CLI::App& app) {
    auto options = std::make_shared<CheckGradientCommandOptions>();
    CLI::App* command = app.add_subcommand(
        "check-gradient", "Compares the derivative of images with finite differences");
    command
        ->add_option("--parameter", options->parameters,
                     "A texture, or a constant in its place; `burnish info` lists them; repeatable")
        ->type_name("NAME[:SIZE]")
        ->required();
    add_number(*command, "--spp", options->check.samples, "N",
               "Samples per pixel of each of the two, rounded up to a multiple of 32",
               {kCheckBatches, kMaxSamplesPerPixel, true});
    add_choice(*command, "--estimator", options->check.estimator, "How the derivative is estimated",
               has_own_derivatives);
    add_texture_option(*command, options->textures);
    add_render_options(*command, options->scene);
    command->callback([options] {
        options->check.seed = options->scene.seed;
        run(*options);
    });
}

}  // namespace burnish
