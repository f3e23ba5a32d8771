#include "cli/command_line.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/failures.h"
#include "cli/help.h"
#include "cli/interrupt.h"
#include "cli/run_checkpoints.h"
#include "cli/usage_text.h"
#include "core/version.h"
#include "optimize/ranks.h"

namespace burnish {

namespace {

constexpr const char* kDescription =
    "Burnish recovers textures of materials from images, by gradient descent through a physically "
    "based renderer. Scenes are Mitsuba 3 XML files. `burnish COMMAND --help` says more.";

void add_commands(CLI::App& app, const Ranks& ranks) {
    app.name("burnish");
    app.description(kDescription);
    app.set_version_flag("--version", version_text());
    app.require_subcommand(0, 1);  // run_command_line asks for one: a clearer sentence
    add_new_command(app);
    add_optimize_command(app, ranks);
    add_batch_command(app, ranks);
    add_render_command(app);
    add_gradient_command(app);
    add_check_gradient_command(app);
    add_info_command(app);
    add_scene_command(app);
    add_reproduce_command(app);
    add_options_command(app);
    arrange_help(app, help_width());
}

/// Whether all that was printed arrived. A reader that left is no error: it has what it wanted.
int finish_output(int error = 0) {
    if (error == 0 && std::fflush(stdout) != 0) error = errno;
    if (error == 0 || error == EPIPE) return 0;
    report_error(fmt::format("standard output cannot be written: {}", std::strerror(error)));
    return kInputOutput;
}

/// Returns the exit status.
int print_asked(const std::string& text) {
    return finish_output(std::fputs(text.c_str(), stdout) == EOF ? errno : 0);
}

int usage_error(const CLI::App& app, const std::string& text) {
    report_error(one_line(text) + " (see " + command_path(app) +
                 (has_help_all(app) ? " --help-all)" : " --help)"));
    return kBadUsage;
}

int report(const Failure& failure) {
    report_error(failure.text);
    return failure.code;
}

int run_command(int argc, char** argv, const Ranks& ranks) {
    CLI::App app;
    add_commands(app, ranks);
    try {
        app.parse(argc, argv);
        if (!app.get_subcommands().empty()) return finish_output();
        throw UsageError(
            "expected a command: new, optimize, batch, render, gradient, check-gradient, info, "
            "scene or reproduce");
    } catch (const CLI::Success& help) {
        return is_first(ranks) ? print_asked(help_text(app, help)) : kDone;
    } catch (const CLI::ParseError& error) {
        return usage_error(app, usage_text(app, error));
    } catch (const UsageError& error) {
        return usage_error(app, error.what());
    } catch (const Suspended& suspended) {
        log_info(suspended.what());
        return kInterrupted;
    } catch (const UnprintedLine& error) {
        return finish_output(error.code().value());
    } catch (const std::exception&) {
        return report(current_failure());
    }
}

/// A file that is opened gets the number of a standard stream that is closed: what is said would
/// be written into it. What stands there instead fails as a closed one does.
void occupy_closed_streams() {
    for (const int stream : {0, 1, 2})
        if (fcntl(stream, F_GETFD) < 0) open("/dev/null", stream == 0 ? O_WRONLY : O_RDONLY);
}

}  // namespace

int run_command_line(int argc, char** argv, JoinedProcess* process) {
    occupy_closed_streams();
    try {
        watch_signals();
    } catch (const std::exception&) {
        return report(current_failure());
    }
    if (!process) return run_command(argc, argv, {});
    const Ranks ranks = process->join();
    if (is_first(ranks)) return run_command(argc, argv, ranks);
    ignore_interrupts();
    be_quiet();
    const std::string_view command = argc > 1 ? argv[1] : "";
    if (command != "optimize" && command != "batch") return kDone;  // the first does it alone
    const int status = run_command(argc, argv, ranks);
    process->error = last_error();
    return status;
}

}  // namespace burnish
