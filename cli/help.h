// How --help looks.
#pragma once

#include <cstddef>
#include <string>

namespace CLI {
class App;
class Success;
}  // namespace CLI

namespace burnish {

/// The group of options that --help leaves out. --help-all shows those of them that have a
/// description.
inline constexpr const char* kMoreOptions = "More options";

/// Columns of the terminal that standard output is, from 60 to 100; 100 where it is none.
std::size_t help_width();

/// Options as "--spp N [32]", with the default in brackets; descriptions are wrapped to the width.
/// Call it when all options of all commands are there.
void arrange_help(CLI::App& app, std::size_t width);

/// What was asked for instead of a run: help, or the version.
std::string help_text(CLI::App& app, const CLI::Success& asked);

/// Line breaks between words so that no line exceeds the width, where its words admit it. indent:
/// spaces before each further line.
std::string wrap(const std::string& text, std::size_t width, std::size_t indent = 0);

}  // namespace burnish
