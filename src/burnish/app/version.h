// What this program is and what it was built with.
#pragma once

#include <string>

namespace burnish {

/// "0.1.0"
std::string version();
/// The compiler, as it names itself.
std::string compiler();
/// One line for --version.
std::string version_text();

}  // namespace burnish
