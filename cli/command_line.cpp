#include "cli/command_line.h"

#include <CLI/CLI.hpp>
#include <new>

#include "burnish/error.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/help.h"
#include "cli/interrupt.h"
#include "core/version.h"

namespace burnish {

namespace {

constexpr int kBadInput = 1, kBadUsage = 2;

constexpr const char* kDescription =
    "Burnish recovers textures of materials from images, by gradient descent through a physically\n"
    "based renderer. Scenes are Mitsuba 3 XML files. `burnish COMMAND --help` says more.";

void add_commands(CLI::App& app) {
    app.name("burnish");
    app.description(kDescription);
    app.set_version_flag("--version", version_text());
    app.require_subcommand(0, 1);  // run_command_line asks for one: a clearer sentence
    add_new_command(app);
    add_optimize_command(app);
    add_render_command(app);
    add_gradient_command(app);
    add_info_command(app);
    add_scene_command(app);
    add_reproduce_command(app);
    add_options_command(app);
    arrange_help(app);
}

/// The command whose options were being read, for a hint: "burnish", "burnish render", ...
std::string command_path(const CLI::App& app) {
    for (const CLI::App* command : app.get_subcommands()) return "burnish " + command->get_name();
    return "burnish";
}

int usage_error(const CLI::App& app, const std::string& text) {
    report_error(one_line(text) + " (see " + command_path(app) + " --help)");
    return kBadUsage;
}

int input_error(const std::string& text) {
    report_error(one_line(text));
    return kBadInput;
}

}  // namespace

int run_command_line(int argc, char** argv) {
    watch_signals();
    CLI::App app;
    add_commands(app);
    try {
        app.parse(argc, argv);
        if (!app.get_subcommands().empty()) return 0;
        throw UsageError(
            "expected a command: new, optimize, render, gradient, info, scene or reproduce");
    } catch (const CLI::Success& help) {
        return app.exit(help);
    } catch (const CLI::ParseError& error) {
        return usage_error(app, error.what());
    } catch (const UsageError& error) {
        return usage_error(app, error.what());
    } catch (const Error& error) {
        return input_error(error.what());
    } catch (const std::bad_alloc&) {
        return input_error(
            "there is not enough memory for this scene and these sizes: a smaller --size or fewer "
            "samples per pixel of the derivative take less");
    } catch (const std::exception& error) {
        return input_error(error.what());
    }
}

}  // namespace burnish
