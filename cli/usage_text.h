// What is wrong with a command line, in one sentence.
#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace burnish {

/// The command whose options were being read, as people type it: "burnish", "burnish render".
std::string command_path(const CLI::App& app);
/// Whether --help of that command leaves options out, which --help-all shows.
bool has_help_all(const CLI::App& app);

/// Of what the parser of `app` has thrown: names the argument, and what may have been meant.
std::string usage_text(const CLI::App& app, const CLI::ParseError& error);

}  // namespace burnish
