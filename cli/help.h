// How --help looks.
#pragma once

namespace CLI {
class App;
}

namespace burnish {

/// Options as "--spp N [32]", with the default in brackets; long descriptions are wrapped. Call it
/// when all options of all commands are there.
void arrange_help(CLI::App& app);

}  // namespace burnish
