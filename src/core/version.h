// What this program is and what it was built with.
#pragma once

#include <string>

namespace burnish {

/// "0.1.0"
std::string version();
/// The compiler, as it names itself.
std::string compiler();
/// What the code that runs was compiled for: "x86-64-v3", ...; the highest level that holds.
std::string instruction_set();
/// One line for --version.
std::string version_text();

}  // namespace burnish
