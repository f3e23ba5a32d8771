// What somebody may have meant.
#pragma once

#include <string>
#include <vector>

namespace burnish {

/// The name that is nearest to what was written, by the letters to add, drop, replace or exchange
/// with the next one; empty where none is near: more than a third of the letters differ.
std::string nearest_name(const std::string& written, const std::vector<std::string>& names);

}  // namespace burnish
