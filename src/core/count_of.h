// Counts in messages.
#pragma once

#include <cstdint>
#include <string>

namespace burnish {

/// "1 view", "2 views".
inline std::string count_of(std::int64_t count, const std::string& one) {
    return std::to_string(count) + " " + one + (count == 1 ? "" : "s");
}

}  // namespace burnish
