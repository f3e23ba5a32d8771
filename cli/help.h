// How --help looks.
#pragma once

#include <cstddef>
#include <string>

namespace CLI {
class App;
}

namespace burnish {

/// Options as "--spp N [32]", with the default in brackets; long descriptions are wrapped. Call it
/// when all options of all commands are there.
void arrange_help(CLI::App& app);

/// Line breaks between words so that no line exceeds the width.
std::string wrap(const std::string& text, std::size_t width);

}  // namespace burnish
