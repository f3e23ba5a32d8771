// What a run is made of, to tell whether it has changed.
#pragma once

#include <cstdint>
#include <string>

namespace burnish {

/// Something that a run was made of.
struct Input {
    std::string name = {};              ///< a file, or what it is in words
    std::uint64_t bytes = 0, hash = 0;  ///< XXH3

    friend bool operator==(const Input&, const Input&) = default;
};

}  // namespace burnish
