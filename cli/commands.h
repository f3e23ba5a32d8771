// The commands of the command line. Each adds its options to the program and, once they are parsed,
// runs. Throws UsageError and InputError.
//
// To add a command: a function here, its file NAME_command.cpp, and a call in command_line.cpp.
#pragma once

#include <stdexcept>

#include "burnish/ranks.h"

namespace CLI {
class App;
}

namespace burnish {

/// Options that do not go together. what() is one sentence.
struct UsageError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

void add_new_command(CLI::App& app);
/// ranks: processes that run the command together.
void add_optimize_command(CLI::App& app, const Ranks& ranks);
void add_batch_command(CLI::App& app, const Ranks& ranks);
void add_render_command(CLI::App& app);
void add_gradient_command(CLI::App& app);
void add_check_gradient_command(CLI::App& app);
void add_info_command(CLI::App& app);
void add_scene_command(CLI::App& app);
void add_reproduce_command(CLI::App& app);
void add_options_command(CLI::App& app);

}  // namespace burnish
