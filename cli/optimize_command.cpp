// burnish optimize: recovers textures from an image.

#include <CLI/App.hpp>

#include "cli/commands.h"
#include "cli/optimize_run.h"

namespace burnish {

void add_optimize_command(CLI::App& app, const Ranks& ranks) {
    auto arguments = std::make_shared<OptimizeArguments>();
    CLI::App* command = app.add_subcommand(
        "optimize",
        "Recovers textures from an image; without a scene, those of the built-in goblet");
    add_optimize_options(*command, *arguments);
    command->callback([arguments, &ranks] {
        if (arguments->resume.empty())
            begin_run(make_settings(*arguments), ranks);
        else
            resume_run(*arguments, ranks);
    });
}

}  // namespace burnish
