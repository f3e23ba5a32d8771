// The options of `burnish optimize`, made from the tables of settings: parsing, what the built-in
// goblet sets, and what goes together.
#pragma once

#include "cli/settings.h"

namespace CLI {
class App;
}

namespace burnish {

/// What was given on the command line, in order.
struct OptimizeArguments {
    std::string scene;
    std::vector<Given> flags;
    std::vector<std::string> sets;  ///< "NAME=VALUE"
    std::string options_file;
    std::string resume;          ///< folder of the run that goes on
    std::vector<Given> options;  ///< as of an options file, and before it: of a list of jobs
};

/// Adds all options. `arguments` must outlive the parsing.
void add_optimize_options(CLI::App& command, OptimizeArguments& arguments);

/// Defaults < those of the demo < the options file < the command line. Throws UsageError and
/// InputError: an option does not fit, is ruled out by others, or contradicts another one.
Settings make_settings(const OptimizeArguments& arguments);

/// What is given beside --resume. Throws UsageError where that is more than what may change.
std::vector<Given> changes_of(const OptimizeArguments& arguments);
/// Those of the run in a folder that goes on: its own, recorded as JSON, and changes over them.
/// Throws UsageError: the viewer's address is none.
Settings resumed_settings(const std::string& folder, const std::string& recorded,
                          const std::vector<Given>& changes);
/// Takes what decides on no byte of a run that goes on: threads, the limit of the memory, the
/// viewer, the time between checkpoints.
void take_process(const RunSettings& from, RunSettings& to);

}  // namespace burnish
