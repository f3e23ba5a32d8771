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

/// Options as "--spp N [32]", with the default in brackets; long descriptions are wrapped. Call it
/// when all options of all commands are there.
void arrange_help(CLI::App& app);

/// What was asked for instead of a run: help, or the version.
std::string help_text(CLI::App& app, const CLI::Success& asked);

/// Line breaks between words so that no line exceeds the width.
std::string wrap(const std::string& text, std::size_t width);

}  // namespace burnish
